within JointStiffness.Components;
model HarmonicDriveSpring "Torsional spring and damper of a harmonic drive between two flanges"
  parameter JointStiffness.Data.HarmonicDrive data = JointStiffness.Data.CD_14_100_of_Hu_2023() "The drive"
    annotation (choicesAllMatching=true);
  parameter Real ratio = data.ratio "speed ratio of wave generator and output; negative: they turn in opposite senses; not 0";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) = data.d "viscous damping at the output";
  parameter Modelica.Units.SI.Torque hysteresis_friction(min=0) = data.hysteresis_friction "Friction torque of the hysteresis; 0: none"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.RotationalSpringConstant hysteresis_stiffness(min=0) = data.hysteresis_stiffness "additional stiffness for small motions, before the hysteresis friction slips"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_coulomb(min=0) = data.friction_coulomb "dry friction torque at the wave generator, independent of speed and load"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_stribeck(min=0) = data.friction_stribeck "extra dry friction at standstill that vanishes with speed (Stribeck)"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.AngularVelocity stribeck_speed(min=Modelica.Constants.small) = data.stribeck_speed "speed of the wave generator at which friction_stribeck has decreased to 1/e"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.RotationalDampingConstant friction_viscous(min=0) = data.friction_viscous "viscous friction coefficient at the wave generator"
    annotation (Dialog(tab="Friction"));
  parameter Real load_loss(min=0, unit="1") = data.load_loss "load-dependent dry friction torque divided by the torque transmitted to the wave generator"
    annotation (Dialog(tab="Friction"));
  parameter Real load_loss_back(unit="1") = data.load_loss_back "load_loss while the load drives the motor; negative: equal to load_loss"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_1(min=0) = data.friction_1 "amplitude of friction_coulomb, one period per turn of the wave generator"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle friction_1_phase = data.friction_1_phase "phase of friction_1 at phi1 = 0"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_2(min=0) = data.friction_2 "amplitude of friction_coulomb, two periods per turn of the wave generator"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle friction_2_phase = data.friction_2_phase "phase of friction_2 at phi1 = 0"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle presliding(min=Modelica.Constants.small) = data.presliding "angle of the wave generator over which dry friction builds up to 1 - 1/e"
    annotation (Dialog(tab="Friction"));
  parameter Real temperature_factor(min=0, unit="1") = data.temperature_factor "factor that multiplies all friction"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.LinearTemperatureCoefficient viscous_temperature_coefficient = data.viscous_temperature_coefficient "relative decrease of friction_viscous per kelvin above 293.15 K"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.LinearTemperatureCoefficient dry_temperature_coefficient = data.dry_temperature_coefficient "relative decrease of dry friction per kelvin above 293.15 K"
    annotation (Dialog(tab="Friction"));
  parameter Boolean useHeatPort = false "= true, if heatPort is enabled: it sets the temperature and receives lossPower"
    annotation (Evaluate=true, HideResult=true, choices(checkBox=true), Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Temperature T = data.T "Temperature of the lubricant, if useHeatPort = false"
    annotation (Dialog(tab="Friction", enable=not useHeatPort));
  parameter Modelica.Units.SI.Angle error_1 = data.error_1 "kinematic error at the output, amplitude, one period per turn of the wave generator"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_1_phase = data.error_1_phase "phase of error_1 at phi1 = 0"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_2 = data.error_2 "kinematic error at the output, amplitude, two periods per turn"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_2_phase = data.error_2_phase "phase of error_2 at phi1 = 0"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_4 = data.error_4 "kinematic error at the output, amplitude, four periods per turn"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_4_phase = data.error_4_phase "phase of error_4 at phi1 = 0"
    annotation (Dialog(tab="Kinematic error"));
  parameter Boolean use_damping = true "false: the wind-up follows the torque without delay; no damping, hysteresis or friction"
    annotation (Evaluate=true, Dialog(tab="Advanced"));
  parameter StateSelect stateSelect=StateSelect.default "Priority to use phi_rel and w_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wave generator (motor)"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Output"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Thermal.HeatTransfer.Interfaces.HeatPort_a heatPort(T=temperature, Q_flow=-lossPower) if useHeatPort "Lubricant"
    annotation (Placement(transformation(extent={{-10,-110},{10,-90}})));
  Modelica.Units.SI.Temperature temperature "temperature of the lubricant";
  Modelica.Units.SI.Angle phi_rel(start=0, nominal=1e-3, stateSelect=stateSelect)
    "wind-up at the output, phi2 - phi1/ratio - phi_error (= flange_b.phi - flange_a.phi/ratio - phi_error)";
  Modelica.Units.SI.Angle phi_error(nominal=1e-4) "kinematic error at the output, a function of phi1";
  Modelica.Units.SI.AngularVelocity w_rel(start=0, nominal=1, stateSelect=stateSelect) "Rate of the wind-up; 0 with use_damping=false";
  Modelica.Units.SI.Torque tau_c(nominal=5) "Torque of the spring";
  Modelica.Units.SI.Torque tau_h(nominal=0.1) "Torque of the hysteresis";
  Modelica.Units.SI.Torque tau(nominal=5) "Torque at the output (= flange_b.tau)";
  Modelica.Units.SI.AngularVelocity w1 "Speed of the wave generator; 0 with use_damping=false";
  Modelica.Units.SI.Torque tau_friction(nominal=0.01) "friction torque at the wave generator, positive if it opposes positive rotation";
  Modelica.Units.SI.RotationalSpringConstant K_WTS(nominal=5e3) "tangent stiffness dT/dphi of the midline at the present wind-up";
  Modelica.Units.SI.RotationalSpringConstant K_TS(nominal=5e3) "stiffness of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS";
  Modelica.Units.SI.Power lossPower "Power dissipated by damper and friction";
protected
  constant Real layer=1e-3 "Width of the transition from stick to slip of a slider at the wave generator, relative to its friction limit";
  constant Modelica.Units.SI.Time turned=0.1 "Duration of the motion before initialization of a drive that turns then";
  constant Modelica.Units.SI.Time forgets=1e-4 "Time constant with which a slider above its friction limit returns to it at rest";
  constant Modelica.Units.SI.Temperature reference=293.15 "Reference temperature of the friction parameters";
  constant Real width=0.01 "Torque, relative to rated torque, within which |tau| is smoothed";
  constant Real brakes[:, 2]=[
      0.234375, 0.02990505504;
      0.203125, 0.08395261345;
      0.171875, 0.1283269962;
      0.140625, 0.1612417451;
      0.109375, 0.1800903629;
      0.078125, 0.1806964323;
      0.046875, 0.155179247;
      0.015625, 0.08060754818] "Stiffness and friction of the sliders at the wave generator, relative to their sums";
  parameter Integer n=size(data.sliders, 1) "Number of sliders of the hysteresis";
  parameter Modelica.Units.SI.RotationalSpringConstant K_h[n]=(if hysteresis_friction > 0 then hysteresis_stiffness else 0)*data.sliders[:, 1] "Stiffness of the hysteresis sliders";
  parameter Modelica.Units.SI.Torque M_h[n]=hysteresis_friction*data.sliders[:, 2] "Friction limits of the hysteresis sliders";
  constant Modelica.Units.SI.AngularVelocity still=1e-7 "Rate of the wind-up beyond which it counts as reversed";
  discrete Modelica.Units.SI.Torque q_h[n](each start=0, each fixed=true, each nominal=0.01) "Torques of the hysteresis sliders at the last reversal of the wind-up";
  discrete Modelica.Units.SI.Angle phi_h(start=0, fixed=true, nominal=1e-3) "Wind-up at the last reversal";
  Boolean ahead(start=false, fixed=true) "The wind-up increases";
  Boolean behind(start=false, fixed=true) "The wind-up decreases";
  Modelica.Units.SI.Torque stuck_h[n] "Torques of the hysteresis sliders if they stick since the last reversal";
  Modelica.Units.SI.Torque held_h[n] "Torques of the hysteresis sliders, within their friction limits";
  Modelica.Units.SI.Torque begun_h[n] "Torques of the hysteresis sliders after a straight path from rest to the present wind-up";
  Modelica.Units.SI.Power heat_h[n] "Power dissipated by the hysteresis sliders";
  parameter Integer m=size(brakes, 1) "Number of sliders of the friction at the wave generator";
  parameter Real loss_back(unit="1")=if load_loss_back < 0 then load_loss else load_loss_back "Value of load_loss when the load drives the motor";
  parameter Modelica.Units.SI.Torque M_rated=temperature_factor*(friction_coulomb + friction_stribeck + max(load_loss, loss_back)*data.rated_torque/abs(ratio)) "Limit of dry friction at rest and rated torque";
  parameter Modelica.Units.SI.RotationalSpringConstant K_w[m]=M_rated/presliding*brakes[:, 1] "Stiffness of the sliders at the wave generator";
  Real f_dry(unit="1") "Temperature factor of the dry friction";
  Real f_viscous(unit="1") "Temperature factor of the viscous friction";
  Modelica.Units.SI.Torque unloaded "Limit of dry friction without load, at the reference temperature";
  Modelica.Units.SI.Torque tau_begun "Torque at the output with hysteresis from rest";
  Modelica.Units.SI.Torque M_p "Limit of positive dry friction at the wave generator";
  Modelica.Units.SI.Torque M_n "Limit of negative dry friction at the wave generator";
  Modelica.Units.SI.Torque q_w[m](each start=0, each nominal=0.01) "Torques of the sliders at the wave generator, at most one transition width above their limits";
  Modelica.Units.SI.Torque held_w[m] "Torques of the sliders at the wave generator, within their friction limits";
  Real rate_w[m](each unit="N.m/s") "Rates of q_w";
  Modelica.Units.SI.Power heat_w[m] "Power dissipated by the sliders at the wave generator";
  Real errorSlope "Derivative of phi_error with respect to flange_a.phi";
  Modelica.Units.SI.Angle windUp "Absolute value of the wind-up";
initial equation
  for i in 1:m loop
    q_w[i] = min(max(turned*K_w[i]*w1,
      -f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau_begun, width*data.rated_torque, -ratio)*brakes[i, 2]),
      f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau_begun, width*data.rated_torque, ratio)*brakes[i, 2]);
  end for;
equation
  assert(ratio < 0 or ratio > 0, "ratio = 0 is outside (-inf, 0) and (0, inf)");
  assert(friction_1 + friction_2 <= friction_coulomb, "friction_1 + friction_2 must not exceed friction_coulomb");
  phi_error = error_1*sin(flange_a.phi + error_1_phase) + error_2*sin(2*flange_a.phi + error_2_phase) + error_4*sin(4*flange_a.phi + error_4_phase);
  errorSlope = error_1*cos(flange_a.phi + error_1_phase) + 2*error_2*cos(2*flange_a.phi + error_2_phase) + 4*error_4*cos(4*flange_a.phi + error_4_phase);
  phi_rel = flange_b.phi - flange_a.phi/ratio - phi_error;
  if use_damping then
    w_rel = der(phi_rel);
    w1 = der(flange_a.phi);
    tau = tau_c + tau_h + d*w_rel;
  else
    w_rel = 0;
    w1 = 0;
    tau = tau_c + tau_h;
  end if;
  // sliders of the hysteresis: a spring each, from the last turn on, that friction holds no further
  for i in 1:n loop
    stuck_h[i] = q_h[i] + K_h[i]*(phi_rel - phi_h);
    held_h[i] = noEvent(min(max(stuck_h[i], -M_h[i]), M_h[i]));
    begun_h[i] = noEvent(min(max(K_h[i]*phi_rel, -M_h[i]), M_h[i]));
    heat_h[i] = noEvent(if abs(stuck_h[i]) > M_h[i] then M_h[i]*abs(w_rel) else 0);
  end for;
  ahead = (if hysteresis_friction > 0 then w_rel else 0) > still;
  behind = (if hysteresis_friction > 0 then w_rel else 0) < -still;
  when {initial(), pre(ahead), pre(behind)} then
    q_h = JointStiffness.Functions.limited(pre(q_h) + K_h*(phi_rel - pre(phi_h)), M_h);
    phi_h = phi_rel;
  end when;
  tau_h = if use_damping then sum(held_h) else 0;
  tau_begun = tau_c + d*w_rel + sum(begun_h);
  if not useHeatPort then
    temperature = T;
  end if;
  f_dry = temperature_factor*exp(-dry_temperature_coefficient*(temperature - reference));
  f_viscous = temperature_factor*exp(-viscous_temperature_coefficient*(temperature - reference));
  unloaded = friction_coulomb + friction_stribeck*exp(-(w1/stribeck_speed)^2) + friction_1*sin(flange_a.phi + friction_1_phase) + friction_2*sin(2*flange_a.phi + friction_2_phase);
  M_p = f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau, width*data.rated_torque, ratio);
  M_n = f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau, width*data.rated_torque, -ratio);
  // sliders of the friction: a spring each, that follows the motion until its friction holds no more
  for i in 1:m loop
    held_w[i] = noEvent(min(max(q_w[i], -M_n*brakes[i, 2]), M_p*brakes[i, 2]));
    rate_w[i] = K_w[i]*(w1 - noEvent(abs(w1))*(q_w[i] - held_w[i])/(layer*M_rated*brakes[i, 2] + Modelica.Constants.small)) - (q_w[i] - held_w[i])/forgets;
    der(q_w[i]) = rate_w[i];
    heat_w[i] = held_w[i]*w1 - q_w[i]*rate_w[i]/max(K_w[i], Modelica.Constants.small);
  end for;
  tau_friction = sum(held_w) + f_viscous*friction_viscous*w1;
  windUp = noEvent(if phi_rel < 0 then -phi_rel else phi_rel);
  tau_c = noEvent(if phi_rel < 0 then -1 else 1)*JointStiffness.Functions.load(windUp, data.table);
  K_WTS = JointStiffness.Functions.stiffness(windUp, data.table);
  K_TS = 1/(1/K_WTS - 1/data.K_FTS0);
  flange_b.tau = tau;
  flange_a.tau = -(tau/ratio + errorSlope*tau) + tau_friction;
  lossPower = d*w_rel^2 + f_viscous*friction_viscous*w1^2 + sum(heat_h) + sum(heat_w);
  annotation (
    defaultComponentName="harmonicDrive",
    Icon(graphics={
      Rectangle(extent={{-100,10},{-64,-10}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{64,10},{100,-10}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-56,48},{56,-48}}, lineColor={31,95,168}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, lineThickness=1.0),
      Ellipse(extent={{-42,32},{42,-32}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{-30,0},{-20,0},{-16,12},{-8,-12},{0,12},{8,-12},{16,12},{20,0},{30,0}}, color={209,67,43}, thickness=0.5),
      Text(extent={{-150,115},{150,75}}, textColor={0,0,255}, textString="%name"),
      Text(extent={{-150,-80},{150,-110}}, textString="ratio=%ratio")}),
    Documentation(info="<html>
<p>The torsional spring and damper between the wave generator (motor, flange 1) and the output (flange 2) of a harmonic drive. The inertias are not included: connect one to each flange.</p>
<p>The stiffness comes from the rough contact of flexspline and flexible bearing: a larger torque increases the contact area, so the stiffness increases with the torque. Circular spline and flexspline are a constant stiffness in series.</p>
<h4>Flanges</h4>
<p>The wind-up is positive if the output is ahead of the motor. The housing is fixed and carries the difference of the two torques. Inertias are not included: connect one to each flange. If one flange is fixed and the other has a given torque but no inertia, the damper determines the speed; with <code>d</code> = 0 this is a division by zero. Then set <code>use_damping=false</code>: the wind-up follows the torque without delay.</p>
<h4>Law</h4>
<p>τ = T(φ<sub>rel</sub>) + T<sub>h</sub> + d dφ<sub>rel</sub>/dt, &emsp; T the inverse of φ(T)</p>
<p>φ<sub>rel</sub> = φ<sub>2</sub> − φ<sub>1</sub>/ratio − φ<sub>e</sub>(φ<sub>1</sub>), &emsp; τ<sub>1</sub> = τ (1/ratio + dφ<sub>e</sub>/dφ<sub>1</sub>) − τ<sub>friction</sub>, &emsp; τ<sub>2</sub> = −τ</p>
<p>φ<sub>e</sub> = Σ error_n sin(n φ<sub>1</sub> + error_n_phase), &emsp; n = 1, 2, 4</p>
<p>φ<sub>e</sub>, the output <code>phi_error</code>, is the kinematic error at the output. φ<sub>1</sub> is measured from the housing: both lobes of the wave generator pass every tooth once per turn, so the component with two periods per turn, <code>error_2</code>, is usually the largest. The torque on the wave generator follows from virtual work. At constant motor speed the output vibrates, most strongly if the wave generator turns at half the natural frequency.</p>
<p>M = f<sub>dry</sub> [friction_coulomb + friction_stribeck exp(−(w<sub>1</sub>/stribeck_speed)<sup>2</sup>) + friction_1 sin(φ<sub>1</sub> + friction_1_phase) + friction_2 sin(2φ<sub>1</sub> + friction_2_phase) + loss |τ/ratio|]</p>
<p>loss = <code>load_loss</code> if the motor drives the load, and <code>load_loss_back</code> if the load drives the motor; the latter also limits the load that friction holds at rest.</p>
<p>Friction at the wave generator, the output <code>tau_friction</code>, is dry friction with the limit M, plus f<sub>viscous</sub> <code>friction_viscous · w1</code>, with f = <code>temperature_factor</code> exp(−coefficient (<code>temperature</code> − 293.15 K)), where the coefficient is <code>dry_temperature_coefficient</code> or <code>viscous_temperature_coefficient</code>. Dry friction builds up over the angle φ<sub>1</sub>, from rest as M [1 − exp(−φ<sub>1</sub>/presliding)], with 8 sliders with memory: a drive at rest holds a torque below M without moving. At initialization the sliders are in the state after a long motion with the initial speed. |τ| is smooth at τ = 0: τ tanh(τ/(0.01 T<sub>r</sub>)).</p>
<p>φ(T) = ∫<sub>0</sub><sup>T</sup> dT′ / K<sub>WTS</sub>(T′), &emsp; odd in T</p>
<p>1/K<sub>WTS</sub> = 1/K<sub>FTS</sub> + 1/K<sub>TS</sub> (Hu 2023, Eq. 46)</p>
<p>K<sub>TS</sub> = drive_scale · (A<sub>0</sub>/node_area) · K<sub>T</sub>(p) · 2 radius, &emsp; p = mean_over_peak · P(T) (Eq. 45 as printed)</p>
<p>P is the peak contact pressure between flexspline and bearing ring, at the major axis and the opening of the cup:</p>
<p>P(T) = [ p<sub>0</sub><sup>2</sup> + (p<sub>r</sub><sup>2</sup> − p<sub>0</sub><sup>2</sup>) g(t(T))/g(t(T<sub>r</sub>)) ]<sup>1/2</sup> − deformation_loss (w − w<sub>opt</sub>)<sup>2</sup> − eccentricity_loss · e</p>
<p>g(t) = (t<sup>2</sup> + T<sub>s</sub><sup>2</sup>)<sup>1/2</sup> − T<sub>s</sub>, &emsp; t(T) = T [1 + (T/2T<sub>r</sub>)<sup>4</sup>]<sup>−1/4</sup></p>
<p>with p<sub>0</sub> <code>zero_torque_pressure</code>, p<sub>r</sub> <code>rated_pressure</code> at the <code>rated_torque</code> T<sub>r</sub>, T<sub>s</sub> <code>torque_smoothing</code>, w <code>radial_deformation</code>, w<sub>opt</sub> <code>optimum_deformation</code> and e <code>eccentricity</code>.</p>
<p>K<sub>N</sub> and K<sub>T</sub> of a node are sums over its contact spots up to the largest one, s<sub>l</sub>, all elastic:</p>
<p>p = F<sub>r</sub>/S<sub>r</sub> = (3−D)/(4−D) · 4E/(3π<sup>3/2</sup>R) · s<sub>l</sub><sup>1/2</sup> (Eqs. 17, 28)</p>
<p>K<sub>N</sub> = (D−1)/(D/2−1) · E π<sup>−1/2</sup> ψ<sup>(3−D)/2</sup> s<sub>l</sub><sup>1/2</sup>, &emsp; K<sub>T</sub>/K<sub>N</sub> = (4G′/E) (1 − x)<sup>1/3</sup> (Eqs. 30, 39)</p>
<p><code>lost_motion</code> adds <code>lost_motion</code>/2 · tanh(T/(0.01 T<sub>r</sub>)) to φ(T), a smooth play in series that counts as part of K<sub>TS</sub>. The lost motion in catalogues is the angle between ± 4 % of the rated torque T<sub>r</sub>, in the middle between the branches of the loop. The parameter is the excess of this angle over the elastic wind-up 2 φ(0.04 T<sub>r</sub>).</p>
<p>T<sub>h</sub> is the hysteresis of the FMU: the same sliders, computed from the last reversal of the wind-up (an event). The parameter of the FMU is <code>hysteresis_loss</code>; the parameters of the component are the friction torque and the stiffness for small motions, see the example. The sliders of the friction at the wave generator are those of the FMU too. Their torques are states, and their limit M depends on speed and load. The transition from stick to slip has a width of a thousandth of the friction limit. No torque above the limit acts, so a drive at rest holds its position. If friction needs too many solver steps, use the FMU in its wrapper.</p>
<h4>Not in this table</h4>
<p>The parameters of the law and the lost motion are those of the record <code>data</code>, fixed. With <code>use_damping=false</code> the drive has neither hysteresis nor friction. The table is antisymmetric in the wind-up and ends at 30 N m; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<ul>
<li><b>Validated</b> with the default parameters (CD-14-100): K_TS of the paper at 1 and 3 N m within 2.0 %, its change by eccentricity within 0.7 percentage points. The other published points were used to set the calibration parameters.</li>
<li><b>Scale.</b> The paper's equations, read literally, give the published contact stiffness without a fit, as a sum in newtons over the nodes of a mesh. It contradicts the published drive stiffness by a factor of about 4, <code>drive_scale</code>, whose cause is not known. <code>K_TS_pair</code> is on the paper's scale.</li>
<li><b>Estimates.</b> Base radius, ratio of mean to peak pressure, yield strengths and damping are not published. All contact spots are assumed elastic; parameters for which spots would yield are an error.</li>
<li><b>Beyond rated torque</b> the stiffness approaches its value at twice the rated torque and then stays constant, as for catalogue drives. This is an extrapolation.</li>
<li><b>Range.</b> The table ends at <code>max_torque</code>. Parameters for which the pair has no contact at zero torque are an error.</li>
<li><b>Friction and kinematic error</b> are empirical: their parameters come from a catalogue (starting torque, no-load running torque over speed, efficiency, back-driving torque) or a measurement. The transmission accuracy in a catalogue is the peak-to-peak value of all harmonics.</li>
<li><b>Not included:</b> wear, and the effect of temperature on stiffness and fits. Temperature affects the friction only, with coefficients that were not measured on a drive.</li>
</ul>
<p>Q. Hu, H. Li, G. Wang, L. Li: <em>Research on torsional stiffness of flexspline-flexible bearing contact pair in harmonic drive based on macro-micro scale modeling.</em> Frontiers in Materials 10, 2023. <a href=\"https://doi.org/10.3389/fmats.2023.1211019\">doi:10.3389/fmats.2023.1211019</a></p>
</html>"));
end HarmonicDriveSpring;
