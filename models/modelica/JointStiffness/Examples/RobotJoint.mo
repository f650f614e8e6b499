within JointStiffness.Examples;
model RobotJoint "Motor, harmonic drive and a link in gravity"
  extends Modelica.Icons.Example;
  JointStiffness.Components.Load load(
    ramp_height=0.01, ramp_start=0.1, ramp_duration=0.5,
    pulse_height=0.03, pulse_start=1, pulse_rise=0.002, pulse_hold=0.006)
    annotation (Placement(transformation(extent={{-76,-10},{-56,10}})));
  Modelica.Mechanics.Rotational.Sources.Torque torque
    annotation (Placement(transformation(extent={{-42,-10},{-22,10}})));
  Modelica.Mechanics.Rotational.Components.Inertia motor(J=1e-05, phi(fixed=true, start=0, nominal=0.1), w(fixed=true, start=0, nominal=10))
    annotation (Placement(transformation(extent={{-14,-10},{6,10}})));
  JointStiffness.Components.HarmonicDriveSpring drive(friction=0.308786603497914, stick=2058.69215731192, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{14,-10},{34,10}})));
  Modelica.Mechanics.Rotational.Components.Inertia link(J=0.05, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{42,-10},{62,10}})));
  JointStiffness.Components.LinkWeight weight(m=1, l=0.2)
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
    experiment(StopTime=2, Interval=0.0005, Tolerance=1e-8),
    Documentation(info="<html>
<p>A motor torque rises and lifts the link against its weight; then a short pulse makes the joint ring. Look at <code>drive.tau</code>, <code>drive.phi_rel</code> and <code>drive.K_WTS</code>: the joint is stiffer under torque. The drive has 1 arcmin of hysteresis (<code>drive.tau_h</code>): the ringing dies out the faster, the wider it is.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>motor.J</code></td><td>1e-05 kg m2</td><td>rotor of a small servo motor and the wave generator; 0.1 kg m2 at the output</td></tr>
<tr><td><code>link.J</code></td><td>0.05 kg m2</td><td>m l^2 and 0.01 kg m2 of its own; the inertia behind the drive's damping d</td></tr>
<tr><td><code>link.m</code></td><td>1 kg</td><td>a light forearm; 1.96 N m of weight at 90 deg, below the rated 5 N m</td></tr>
<tr><td><code>link.l</code></td><td>0.2 m</td><td>from the axis to the centre of mass</td></tr>
<tr><td><code>joint_parameters.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>torque.ramp_height</code></td><td>0.01 N m</td><td>1 N m at the output lifts the link to 30 deg</td></tr>
<tr><td><code>torque.ramp_start</code></td><td>0.1 s</td><td>the system rests before it</td></tr>
<tr><td><code>torque.ramp_duration</code></td><td>0.5 s</td><td>about a quarter of the link's swing</td></tr>
<tr><td><code>torque.pulse_height</code></td><td>0.03 N m</td><td>3 N m at the output; with the ramp below the rated 5 N m</td></tr>
<tr><td><code>torque.pulse_start</code></td><td>1 s</td><td>after the ramp</td></tr>
<tr><td><code>torque.pulse_rise</code></td><td>0.002 s</td><td>an eighth of the joint's period, and of its fall</td></tr>
<tr><td><code>torque.pulse_hold</code></td><td>0.006 s</td><td>with rise and fall half of the joint's period</td></tr>
<tr><td><code>experiment.stop_time</code></td><td>2 s</td><td>the link's swing and the ringing of the joint</td></tr>
<tr><td><code>experiment.interval</code></td><td>0.0005 s</td><td>a thirtieth of the joint's period</td></tr>
</table>
</html>"));
end RobotJoint;
