within JointStiffness.Examples;
model BoltedColumn "A machine column on a bolted joint, struck by a force pulse"
  extends Modelica.Icons.Example;
  JointStiffness.Components.Load load(
    pulse_height=<< v["pulse.height"] >>, pulse_start=<< v["pulse.start"] >>, pulse_rise=<< v["pulse.rise"] >>, pulse_hold=<< v["pulse.hold"] >>)
    annotation (Placement(transformation(extent={{80,-10},{60,10}})));
  Modelica.Mechanics.Translational.Sources.Force force
    annotation (Placement(transformation(extent={{50,-10},{30,10}})));
  Modelica.Mechanics.Translational.Components.Mass column(m=<< v["column.m"] >>, s(fixed=true, start=0), v(fixed=true, start=0))
    annotation (Placement(transformation(extent={{0,-10},{20,10}})));
  JointStiffness.Components.BoltedJoint joint(data=JointStiffness.Data.<< record >>())
    annotation (Placement(transformation(extent={{-50,-4},{-30,16}})));
  Modelica.Mechanics.Translational.Components.Fixed held
    annotation (Placement(transformation(extent={{-20,20},{0,40}})));
equation
  connect(joint.flange_z, column.flange_a)
    annotation (Line(points={{-30,0},{0,0}}, color={0,127,0}));
  connect(column.flange_b, force.flange)
    annotation (Line(points={{20,0},{30,0}}, color={0,127,0}));
  connect(load.y, force.f)
    annotation (Line(points={{59,0},{52,0}}, color={0,0,127}));
  connect(joint.flange_x, held.flange)
    annotation (Line(points={{-30,12},{-10,12},{-10,30}}, color={0,127,0}));
  connect(joint.flange_y, held.flange)
    annotation (Line(points={{-30,6},{-10,6},{-10,30}}, color={0,127,0}));
  annotation (
    experiment(StopTime=<< v["experiment.stop_time"] >>, Interval=<< v["experiment.interval"] >>, Tolerance=1e-8),
    Documentation(info="<html>
<p>A force pulls the column from its joint for a fraction of a millisecond; the column rings at about 3 kHz and decays by the joint's damping. Look at <code>column.s</code>, <code>joint.f[3]</code> and <code>joint.K_n</code>. Sideways the column is held.</p>
<< sources >>
</html>"));
end BoltedColumn;
