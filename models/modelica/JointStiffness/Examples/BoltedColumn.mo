within JointStiffness.Examples;
model BoltedColumn "Column on a bolted joint"
  extends Modelica.Icons.Example;

  JointStiffness.Components.Load load(pulse_height=6000, pulse_start=0.001, pulse_rise=5e-05, pulse_hold=0.00015)
    annotation (Placement(transformation(extent={{-90,70},{-70,90}})));
  Modelica.Mechanics.Translational.Sources.Force load_f
    annotation (Placement(transformation(extent={{-60,70},{-40,90}})));
  Modelica.Mechanics.Translational.Components.Mass column(m=100, s(fixed=true, start=0, nominal=1e-6), v(fixed=true, start=0, nominal=1e-3))
    annotation (Placement(transformation(extent={{-30,70},{-10,90}})));
  JointStiffness.Components.BoltedJoint joint(data=JointStiffness.Data.Box_specimen_of_Zhao_2018_15_kN())
    annotation (Placement(transformation(extent={{30,70},{50,90}})));
  Modelica.Mechanics.Translational.Components.Fixed joint_flange_y_held
    annotation (Placement(transformation(extent={{60,70},{80,90}})));
  Modelica.Mechanics.Translational.Components.Fixed joint_flange_z_held
    annotation (Placement(transformation(extent={{60,40},{80,60}})));
equation
  connect(load.y, load_f.f)
    annotation (Line(points={{-80,80},{-50,80}}));
  connect(load_f.flange, column.flange_a)
    annotation (Line(points={{-50,80},{-20,80}}));
  connect(joint.flange_x, column.flange_b)
    annotation (Line(points={{40,80},{-20,80}}));
  connect(joint.flange_y, joint_flange_y_held.flange)
    annotation (Line(points={{40,80},{70,80}}));
  connect(joint.flange_z, joint_flange_z_held.flange)
    annotation (Line(points={{40,80},{70,50}}));
  annotation (
    experiment(StopTime=0.03, Interval=5e-06, Tolerance=1e-8),
    Documentation(info="<html>
<p>A machine column on a bolted joint, struck sideways by a force pulse.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>load.pulse_height</code></td><td>6000 N</td><td>a third of the friction limit of 18 kN: the joint answers with half of it</td></tr>
<tr><td><code>load.pulse_start</code></td><td>0.001 s</td><td>the system rests before it</td></tr>
<tr><td><code>load.pulse_rise</code></td><td>5e-05 s</td><td>a tenth of the period, and of its fall</td></tr>
<tr><td><code>load.pulse_hold</code></td><td>0.00015 s</td><td>with rise and fall half of the period of 0.5 ms</td></tr>
<tr><td><code>column.m</code></td><td>100 kg</td><td>mass of the joint's parameter file</td></tr>
<tr><td><code>joint.data.preload</code></td><td>15000 N</td><td>Zhao 2018, Table 3: 15 kN per bolt</td></tr>
<tr><td><code>joint.data.moment</code></td><td>0 N m</td><td>Zhao 2018, Table 3: no moment</td></tr>
</table>
</html>"));
end BoltedColumn;
