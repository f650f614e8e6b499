within JointStiffness.Examples;
model RobotJoint "Motor, harmonic drive and a link in gravity"
  extends Modelica.Icons.Example;
  JointStiffness.Components.Load load(
    ramp_height=<< v["torque.ramp_height"] >>, ramp_start=<< v["torque.ramp_start"] >>, ramp_duration=<< v["torque.ramp_duration"] >>,
    pulse_height=<< v["torque.pulse_height"] >>, pulse_start=<< v["torque.pulse_start"] >>, pulse_rise=<< v["torque.pulse_rise"] >>, pulse_hold=<< v["torque.pulse_hold"] >>)
    annotation (Placement(transformation(extent={{-76,-10},{-56,10}})));
  Modelica.Mechanics.Rotational.Sources.Torque torque
    annotation (Placement(transformation(extent={{-42,-10},{-22,10}})));
  Modelica.Mechanics.Rotational.Components.Inertia motor(J=<< v["motor.J"] >>, phi(fixed=true, start=0, nominal=0.1), w(fixed=true, start=0, nominal=10))
    annotation (Placement(transformation(extent={{-14,-10},{6,10}})));
  JointStiffness.Components.HarmonicDriveSpring drive(friction=<< own["friction"] >>, stick=<< own["stick"] >>, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{14,-10},{34,10}})));
  Modelica.Mechanics.Rotational.Components.Inertia link(J=<< v["link.J"] >>, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{42,-10},{62,10}})));
  JointStiffness.Components.LinkWeight weight(m=<< v["link.m"] >>, l=<< v["link.l"] >>)
    annotation (Placement(transformation(extent={{72,-10},{92,10}})));
equation
  connect(load.y, torque.tau)
    annotation (Line(points={{-55,0},{-44,0}}, color={0,0,127}));
  connect(torque.flange, motor.flange_a)
    annotation (Line(points={{-22,0},{-14,0}}));
  connect(motor.flange_b, drive.flange_a)
    annotation (Line(points={{6,0},{14,0}}));
  connect(drive.flange_b, link.flange_a)
    annotation (Line(points={{34,0},{42,0}}));
  connect(link.flange_b, weight.flange)
    annotation (Line(points={{62,0},{72,0}}));
  annotation (
    experiment(StopTime=<< v["experiment.stop_time"] >>, Interval=<< v["experiment.interval"] >>, Tolerance=1e-8),
    Documentation(info="<html>
<p>A motor torque rises and lifts the link against its weight; then a short pulse makes the joint ring. Look at <code>drive.tau</code>, <code>drive.phi_rel</code> and <code>drive.K_WTS</code>: the joint is stiffer under torque. The drive has 1 arcmin of hysteresis (<code>drive.tau_h</code>): the ringing dies out the faster, the wider it is.</p>
<< sources >>
</html>"));
end RobotJoint;
