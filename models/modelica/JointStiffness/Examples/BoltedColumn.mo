within JointStiffness.Examples;
model BoltedColumn "A machine column on a bolted joint, struck sideways by a force pulse"
  extends Modelica.Icons.Example;
  JointStiffness.Components.Load load(
    pulse_height=6000, pulse_start=0.001, pulse_rise=5e-05, pulse_hold=0.00015)
    annotation (Placement(transformation(extent={{80,-10},{60,10}})));
  Modelica.Mechanics.Translational.Sources.Force force
    annotation (Placement(transformation(extent={{50,-10},{30,10}})));
  Modelica.Mechanics.Translational.Components.Mass column(m=100, s(fixed=true, start=0, nominal=1e-6), v(fixed=true, start=0, nominal=1e-3))
    annotation (Placement(transformation(extent={{0,-10},{20,10}})));
  JointStiffness.Components.BoltedJoint joint(data=JointStiffness.Data.Box_specimen_of_Zhao_2018_15_kN())
    annotation (Placement(transformation(extent={{-50,-4},{-30,16}})));
  Modelica.Mechanics.Translational.Components.Fixed held
    annotation (Placement(transformation(extent={{-20,20},{0,40}})));
equation
  connect(joint.flange_x, column.flange_a)
    annotation (Line(points={{-30,12},{-16,12},{-16,0},{0,0}}, color={0,127,0}));
  connect(column.flange_b, force.flange)
    annotation (Line(points={{20,0},{30,0}}, color={0,127,0}));
  connect(load.y, force.f)
    annotation (Line(points={{59,0},{52,0}}, color={0,0,127}));
  connect(joint.flange_z, held.flange)
    annotation (Line(points={{-30,0},{-22,0},{-22,26},{-10,26},{-10,30}}, color={0,127,0}));
  connect(joint.flange_y, held.flange)
    annotation (Line(points={{-30,6},{-10,6},{-10,30}}, color={0,127,0}));
  annotation (
    experiment(StopTime=0.03, Interval=5e-06, Tolerance=1e-8),
    Documentation(info="<html>
<p>A force pulse strikes the column along the rows of bolts; the joint answers with half of its friction limit. The column rings at 1.8 to 2 kHz and decays by the joint's friction alone: the frequency rises and the damping falls with the amplitude. Look at <code>column.s</code>, <code>joint.f[1]</code> and <code>joint.lossPower</code>. Across the rows and along the normal the column is held.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>column.m</code></td><td>100 kg</td><td>mass of the joint's parameter file</td></tr>
<tr><td><code>joint_state.preload</code></td><td>15000 N</td><td>Zhao 2018, Table 3: 15 kN per bolt</td></tr>
<tr><td><code>joint_state.moment</code></td><td>0 N m</td><td>Zhao 2018, Table 3: no moment</td></tr>
<tr><td><code>pulse.height</code></td><td>6000 N</td><td>a third of the friction limit of 18 kN: the joint answers with half of it</td></tr>
<tr><td><code>pulse.start</code></td><td>0.001 s</td><td>the system rests before it</td></tr>
<tr><td><code>pulse.rise</code></td><td>5e-05 s</td><td>a tenth of the period, and of its fall</td></tr>
<tr><td><code>pulse.hold</code></td><td>0.00015 s</td><td>with rise and fall half of the period of 0.5 ms</td></tr>
<tr><td><code>experiment.stop_time</code></td><td>0.03 s</td><td>sixty periods</td></tr>
<tr><td><code>experiment.interval</code></td><td>5e-06 s</td><td>a hundredth of the period</td></tr>
</table>
</html>"));
end BoltedColumn;
