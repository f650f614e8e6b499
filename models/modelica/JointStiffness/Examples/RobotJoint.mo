within JointStiffness.Examples;
model RobotJoint "Robot joint with a harmonic drive"
  extends Modelica.Icons.Example;

  JointStiffness.Components.Load load(ramp_height=0.01, ramp_start=0.1, ramp_duration=0.5, pulse_height=0.03, pulse_start=1, pulse_rise=0.002, pulse_hold=0.006)
    annotation (Placement(transformation(extent={{-90,70},{-70,90}})));
  Modelica.Mechanics.Rotational.Sources.Torque load_tau
    annotation (Placement(transformation(extent={{-60,70},{-40,90}})));
  Modelica.Mechanics.Rotational.Components.Inertia motor(J=1e-05, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{-30,70},{-10,90}})));
  JointStiffness.Components.HarmonicDriveSpring drive(data=JointStiffness.Data.CD_14_100_of_Hu_2023(), hysteresis_friction=0.3087866035, hysteresis_stiffness=2058.692157)
    annotation (Placement(transformation(extent={{30,70},{50,90}})));
  Modelica.Mechanics.Rotational.Components.Inertia link(J=0.05, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{90,70},{110,90}})));
  JointStiffness.Components.LinkWeight link_weight(m=1, l=0.2)
    annotation (Placement(transformation(extent={{120,70},{140,90}})));
equation
  connect(load.y, load_tau.tau)
    annotation (Line(points={{-80,80},{-50,80}}));
  connect(link.flange_b, link_weight.flange)
    annotation (Line(points={{100,80},{130,80}}));
  connect(load_tau.flange, motor.flange_a)
    annotation (Line(points={{-50,80},{-20,80}}));
  connect(drive.flange_a, motor.flange_b)
    annotation (Line(points={{40,80},{-20,80}}));
  connect(drive.flange_b, link.flange_b)
    annotation (Line(points={{40,80},{100,80}}));
  annotation (
    experiment(StopTime=2, Interval=0.0005, Tolerance=1e-8),
    Documentation(info="<html>
<p>Motor, harmonic drive and a link that hangs in gravity.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>load.ramp_height</code></td><td>0.01 N m</td><td>1 N m at the output lifts the link to 30 deg</td></tr>
<tr><td><code>load.ramp_start</code></td><td>0.1 s</td><td>the system rests before it</td></tr>
<tr><td><code>load.ramp_duration</code></td><td>0.5 s</td><td>about a quarter of the link's swing</td></tr>
<tr><td><code>load.pulse_height</code></td><td>0.03 N m</td><td>3 N m at the output; with the ramp below the rated 5 N m</td></tr>
<tr><td><code>load.pulse_start</code></td><td>1 s</td><td>after the ramp</td></tr>
<tr><td><code>load.pulse_rise</code></td><td>0.002 s</td><td>an eighth of the joint's period, and of its fall</td></tr>
<tr><td><code>load.pulse_hold</code></td><td>0.006 s</td><td>with rise and fall half of the joint's period</td></tr>
<tr><td><code>motor.J</code></td><td>1e-05 kg m2</td><td>rotor of a small servo motor and the wave generator; 0.1 kg m2 at the output</td></tr>
<tr><td><code>drive.hysteresis_friction</code></td><td>0.3087866035 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>drive.hysteresis_stiffness</code></td><td>2058.692157 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>link.J</code></td><td>0.05 kg m2</td><td>m l^2 and 0.01 kg m2 of its own; the inertia behind the drive's damping d</td></tr>
<tr><td><code>link_weight.m</code></td><td>1 kg</td><td>a light forearm; 1.96 N m of weight at 90 deg, below the rated 5 N m</td></tr>
<tr><td><code>link_weight.l</code></td><td>0.2 m</td><td>from the axis to the centre of mass</td></tr>
</table>
</html>"));
end RobotJoint;
