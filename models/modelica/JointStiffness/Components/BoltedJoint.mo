within JointStiffness.Components;
model BoltedJoint "Bolted joint at a fixed preload: translation along three axes, side 1 fixed"
  parameter JointStiffness.Data.BoltedJoint data = JointStiffness.Data.Box_specimen_of_Zhao_2018_9_kN() "The tightened joint"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Mass mass(min=0) = data.mass "mass of the structure, used for the equivalent viscous damping";
  parameter Boolean memory = data.memory "true: friction with partial slip and memory; false: elastic joint";
  parameter Boolean damping = data.damping "true: the dashpots C_xx, C_yy, C_zz of Zhao 2018 act";
  parameter Boolean plastic_damping = data.plastic_damping "true: normal damping from the plastic work of first loading (Zhao 2018, Eqs. 19-20)";
  parameter StateSelect stateSelect=StateSelect.default "Priority to use s_rel and v_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_x "Side 2 along x (along the bolt rows)"
    annotation (Placement(transformation(extent={{90,50},{110,70}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_y "Side 2 along y (across the bolt rows)"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_z "Side 2 along the normal, positive: the sides separate"
    annotation (Placement(transformation(extent={{90,-70},{110,-50}})));
  Modelica.Units.SI.Position s_rel[3](each start=0, each nominal=1e-6, each stateSelect=stateSelect)
    "Displacement x, y, z of side 2 from the tightened state";
  Modelica.Units.SI.Velocity v_rel[3](each start=0, each nominal=1e-3, each stateSelect=stateSelect) "Rate of s_rel";
  Modelica.Units.SI.Force f[3](each nominal=1e4) "Restoring force x, y, z on side 2";
  Modelica.Units.SI.TranslationalSpringConstant K_n(nominal=1e10) "Normal stiffness of the interface without shear";
  Modelica.Units.SI.TranslationalSpringConstant K_t(nominal=1e10) "Tangential stiffness in full stick";
  Modelica.Units.SI.TranslationalDampingConstant C_n(nominal=1e4) "equivalent viscous damping along the normal, zero without plastic_damping";
  Modelica.Units.SI.TranslationalDampingConstant C_t(nominal=1e4) "Equivalent viscous damping along x and y";
  Real eta_n "ratio of plastic to elastic work in first loading; it causes damping only if plastic_damping = true";
  Modelica.Units.SI.Power lossPower "Power dissipated by friction and dashpots";
protected
  parameter Integer n=size(data.heights, 1) - 1 "Pairs of sliders";
  parameter Real h[n + 1]=data.heights[:, 1] "Approach at which the springs of a pair begin to touch [m]";
  parameter Real g[n + 1]=data.heights[:, 2] "Normal force at approach h [N]";
  parameter Real k[n + 1]=data.heights[:, 3] "Normal stiffness at approach h [N/m]";
  parameter Modelica.Units.SI.Length still=1e-4*data.mu*data.tight/(data.shear*JointStiffness.Functions.stiffness(0, data.table)) "Distance backwards or sideways beyond which the path is a reversal";
  parameter Real K_t0[2*n]=data.sliders[:, 1] "Stiffness of the sliders at tightening [N/m]";
  parameter Real Q_t0[2*n]=data.sliders[:, 2] "Friction limits of the sliders at tightening [N]";
  constant Real bent=0.2 "Ratio of sideways to forward motion beyond which the path is a reversal too";
  constant Real changed=0.02 "Change of the normal force, relative to that at tightening, after which the slider forces are stored";
  constant Real spread=0.288675134594813 "1/sqrt(12)";
  parameter Integer b=size(data.bolt_forces, 1) "Number of bolts";
  Modelica.Units.SI.Force pull[b](each nominal=1e3) "Change of the bolt forces since tightening; bolts only pull";
  Real c "Approach from the tightened state [m]";
  Real v_c "Rate of c [m/s]";
  Real bend "Derivative of the normal stiffness [N/m2]";
  Real F "Change of the normal force since tightening [N]";
  Real G "Normal force of the interface [N]";
  Real S[n] "Normal stiffness of the springs of a pair [N/m]";
  Real grow[n] "Derivative of S with respect to the approach [N/m2]";
  Real N[n] "Normal force of the springs of a pair [N]";
  Real apart[n] "Half the difference of the normal forces of the two sliders of a pair [N]";
  Real widen[n] "Derivative of apart with respect to the approach [N/m]";
  Real K[2*n] "Stiffness of the sliders [N/m]";
  Real K_rate[2*n] "Rate of K [N/m/s]";
  Real Q[2*n] "Friction limits of the sliders [N]";
  Real Q_rate[2*n] "Rate of Q [N/s]";
  discrete Real q_0[2, 2*n](each start=0, each fixed=true, each nominal=100) "Slider forces at the last stored state [N]";
  discrete Real K_0[2*n](start=K_t0, each fixed=true) "Stiffness of the sliders at the stored state [N/m]";
  discrete Real Q_0[2*n](start=Q_t0, each fixed=true) "Friction limits at the stored state [N]";
  discrete Modelica.Units.SI.Position s_0[2](each start=0, each fixed=true, each nominal=1e-6) "Displacement at the stored state";
  discrete Modelica.Units.SI.Force G_0(start=data.tight, fixed=true, nominal=1e4) "Normal force at the stored state";
  Boolean turned(start=false, fixed=true) "The path has reversed since the stored state";
  Boolean loaded(start=false, fixed=true) "The normal force has changed since the stored state";
  Real u[2] "Displacement since the stored state [m]";
  Real q[2, 2*n](each nominal=100) "Forces of the sliders along x and y [N]";
  Real size_q[2*n] "Magnitude of the slider forces [N]";
  Real slips[2*n] "Slip rate times force of the sliders at their friction limit [W]";
  Real heat[2*n] "Power dissipated by the sliders [W]";
  Real square "Square of the tangential displacement [m2]";
  Real R "Without memory: tangential stiffness in full stick divided by the secant stiffness from the origin";
equation
  c = -s_rel[3];
  v_c = -v_rel[3];
  bend = JointStiffness.Functions.bend(c, data.table);
  F = JointStiffness.Functions.load(c, data.table);
  G = data.tight + F;
  for i in 1:n loop
    S[i] = noEvent(if c > h[i] then max(min(K_n, k[i + 1]) - k[i], 0) else 0);
    grow[i] = noEvent(if c > h[i] and c < h[i + 1] then bend else 0);
    N[i] = noEvent(if c > h[i] then max(min(G, g[i + 1]) - g[i] - k[i]*(min(c, h[i + 1]) - h[i]) + S[i]*max(c - h[i + 1], 0), 0) else 0);
    apart[i] = noEvent(min(S[i]*spread*(min(max(c, h[i]), h[i + 1]) - h[i]), N[i] - S[i]*max(c - h[i + 1], 0)));
    widen[i] = noEvent(if c > h[i] and c < h[i + 1] then min(spread*(S[i] + grow[i]*(c - h[i])), S[i]) else 0);
    K[i] = 0.5*data.shear*S[i];
    K[n + i] = K[i];
    K_rate[i] = 0.5*data.shear*grow[i]*v_c;
    K_rate[n + i] = K_rate[i];
    Q[i] = 0.5*data.mu*(N[i] - apart[i]);
    Q[n + i] = 0.5*data.mu*(N[i] + apart[i]);
    Q_rate[i] = 0.5*data.mu*(S[i] - widen[i])*v_c;
    Q_rate[n + i] = 0.5*data.mu*(S[i] + widen[i])*v_c;
  end for;
  // from where they were last kept on the sliders have come straight
  u = {s_rel[1] - s_0[1], s_rel[2] - s_0[2]};
  turned = (if memory then abs(u[1]*v_rel[2] - u[2]*v_rel[1]) - bent*(u[1]*v_rel[1] + u[2]*v_rel[2]) else -1) > still*sqrt(v_rel[1]^2 + v_rel[2]^2);
  loaded = (if memory then abs(G - G_0) else 0) > changed*data.tight;
  when {pre(turned), pre(loaded)} then
    q_0 = JointStiffness.Functions.slide(pre(q_0), {s_rel[1] - pre(s_0[1]), s_rel[2] - pre(s_0[2])}, pre(K_0), K, pre(Q_0), Q);
    K_0 = K;
    Q_0 = Q;
    s_0 = {s_rel[1], s_rel[2]};
    G_0 = G;
  end when;
  q = JointStiffness.Functions.slide(q_0, u, K_0, K, Q_0, Q);
  for j in 1:2*n loop
    size_q[j] = noEvent(sqrt(max(q[1, j]^2 + q[2, j]^2, 0)));
    slips[j] = noEvent(if size_q[j] > (1 - 1e-9)*Q[j] then max(q[1, j]*v_rel[1] + q[2, j]*v_rel[2] - Q[j]*Q_rate[j]/max(K[j], 1), 0) else 0);
    heat[j] = slips[j] + 0.5*size_q[j]^2*abs(K_rate[j])/max(K[j], 1)^2;
  end for;
  square = s_rel[1]^2 + s_rel[2]^2;
  R = sqrt(1 + square*(K_t/max(data.mu*data.tight, Modelica.Constants.small))^2);
  lossPower = sum(heat) + C_t*(v_rel[1]^2 + v_rel[2]^2) + C_n*v_rel[3]^2;
  s_rel[1] = flange_x.s;
  s_rel[2] = flange_y.s;
  s_rel[3] = flange_z.s;
  v_rel = der(s_rel);
  K_n = JointStiffness.Functions.stiffness(c, data.table);
  K_t = data.shear*K_n;
  eta_n = JointStiffness.Functions.linear(c, data.eta_n);
  // repeats mindlin.viscous_equivalent and spring.motion of the package; tests hold both together
  C_n = if damping and plastic_damping then eta_n*sqrt(mass*max(K_n, 0)) else 0;
  C_t = if damping then data.eta_t*sqrt(mass*max(K_t, 0)) else 0;
  for a in 1:2 loop
    f[a] = -(if memory then sum(q[a, :]) else K_t/R*s_rel[a]) - C_t*v_rel[a];
  end for;
  for j in 1:b loop
    pull[j] = noEvent(max(data.bolts/b*s_rel[3], -data.bolt_forces[j]));
  end for;
  f[3] = F + (if memory then 0 else data.shear*bend*square/(R*(1 + R))) - sum(pull) - C_n*v_rel[3];
  flange_x.f = -f[1];
  flange_y.f = -f[2];
  flange_z.f = -f[3];
  annotation (
    defaultComponentName="boltedJoint",
    Icon(graphics={
      Rectangle(extent={{-90,44},{90,4}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-90,-4},{90,-44}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{-90,0},{-70,6},{-50,-6},{-30,6},{-10,-6},{10,6},{30,-6},{50,6},{70,-6},{90,0}}, color={209,67,43}, thickness=0.75),
      Rectangle(extent={{-14,44},{14,-84}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-28,72},{28,44}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-28,-44},{28,-68}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,120},{150,80}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The interface of a bolted joint, pressed together by the bolts. The contact pressure is high around each bolt and low between the bolts. The bolts are springs of stiffness <code>bolt_stiffness</code> parallel to the interface; with the default 0 they only clamp. The members are not included, although they are usually much softer than the interface: <code>jointfmu new bolted-joint</code> makes the complete joint.</p>
<h4>Flanges</h4>
<p>The three flanges are side 2 along x, y and z, measured from the tightened state; z is the normal, positive when the sides separate. Side 1 is fixed. Fix a flange that does not move with <code>Modelica.Mechanics.Translational.Components.Fixed</code>.</p>
<h4>Law</h4>
<p>All nodes i of the contact, with shares A<sub>i</sub> of the nominal area, follow one curve p(δ) of pressure over approach, from their own pressure at tightening. Force and stiffness derive from one potential:</p>
<p>U(s) = Σ A<sub>i</sub> [ V(δ<sub>i</sub> − s<sub>z</sub>) + ½ ρ p′(δ<sub>i</sub> − s<sub>z</sub>) (s<sub>x</sub><sup>2</sup> + s<sub>y</sub><sup>2</sup>) ] + P<sub>0</sub> s<sub>z</sub> + Σ W<sub>j</sub>(s<sub>z</sub>), &emsp; V′ = p, &emsp; ρ = K<sub>T</sub>/K<sub>N</sub></p>
<p>f = −∂U/∂s − C v, &emsp; K<sub>zz</sub> = ∂<sup>2</sup>U/∂s<sub>z</sub><sup>2</sup>, &emsp; K<sub>xx</sub> = K<sub>yy</sub> = ∂<sup>2</sup>U/∂s<sub>x</sub><sup>2</sup></p>
<p>so a closed path returns its energy, the tangential stiffness follows the normal approach, and shear reacts on the normal force. <code>K_rx</code>, <code>K_ry</code> and <code>K_rz</code> project the stiffness of the nodes on rotations about their centroid; the n bolts of stiffness k = <code>bolt_stiffness</code> add n k to <code>K_zz</code> and their part to <code>K_rx</code> and <code>K_ry</code>, and carry the load when the joint is open. They can only pull: W<sub>j</sub>′ = max(k s<sub>z</sub>, −F<sub>0j</sub>), with F<sub>0j</sub> the force of bolt j at tightening. The bolts determine the pressure at tightening. On a frame the pressure around each bolt follows 1/(1 + (r/decay_length)<sup>2</sup>)<sup>decay_exponent</sup>; on a plate it follows Fernlund's polynomial, (R − r)<sup>3</sup> (3r + R − 4a) from the hole edge a to the radius R of the deformation cone of VDI 2230; a field contains the pressures themselves. The moment M changes the bolt forces of its two rows by ±M/(L<sub>a</sub> N<sub>b</sub>) (Zhao 2018, section 3).</p>
<p>The curve comes from sums over contact spots of truncated area a′ up to the largest one, a′<sub>L</sub>, whose load is p A<sub>0</sub>:</p>
<p>n(a′) = ½ D ψ<sup>1−D/2</sup> a′<sub>L</sub><sup>D/2</sup> a′<sup>−(D+2)/2</sup> (Zhao 2018, Eq. 2)</p>
<p>F = ∫ f n da′, &emsp; f = H a′ below a′<sub>c</sub>, &emsp; f = (4/3) E* R<sup>1/2</sup> δ<sup>3/2</sup> above (Eqs. 4-10, 4 and 9 corrected)</p>
<p>K<sub>N</sub> = ∫ k<sub>n</sub> n da′, &emsp; K<sub>T</sub> = ∫ 8 G′ r (1 − x)<sup>1/3</sup> n da′, &emsp; dp/dδ = K<sub>N</sub>/A<sub>0</sub> (Eqs. 14, 22)</p>
<p>C<sub>n</sub> = η<sub>n</sub> (m K<sub>N</sub>)<sup>1/2</sup> if plastic_damping, else 0, &emsp; η<sub>n</sub> = Σ W<sub>plastic</sub> / Σ W<sub>elastic</sub> (Eqs. 16-20, corrected)</p>
<p>C<sub>t</sub> = η<sub>t</sub> (m K<sub>T</sub>)<sup>1/2</sup>, &emsp; 1/η<sub>t</sub> = (5π/12) H<sub>2</sub>/H<sub>1</sub> − 1, &emsp; of Mindlin's loop at x = traction_ratio (Eq. 29, corrected)</p>
<p>All nodes of the joint at its preload and moment add up to one curve g(c) of the total force over the approach c = -s<sub>z</sub>, from which normal force and friction follow: f<sub>z</sub> = g(c) - g(0) - &Sigma; max(k s<sub>z</sub>, -F<sub>0</sub>). F<sub>0</sub> is the force of a bolt at tightening: when its force reaches zero, its head lifts off. Friction is modelled by 28 sliders, whose forces along x and y are computed from the state stored at the last event: a reversal of the displacement, or a change of the normal force by a fiftieth of that at tightening. Each slider combines springs at neighbouring heights, of the tangential stiffness &rho; g''(h) dh at the height h, and slips at &mu; times their normal force. The sums of their stiffness, &rho; g'(c), and of their friction, &mu; g(c), are exact at every approach.</p>
<p>With <code>memory=false</code> shear is elastic, approaches &mu; g(0) and changes the normal force, with the FMU's law for the sum of its nodes: R = (1 + (&rho; g'(c) u/(&mu; g(0)))<sup>2</sup>)<sup>&frac12;</sup> at the displacement u, f<sub>x</sub> = -&rho; g'(c) s<sub>x</sub>/R, f<sub>z</sub> as above and &rho; g''(c) u<sup>2</sup>/(R (1 + R)).</p>
<h4>Not in this table</h4>
<ul>
<li>Preload and moment are those of the record <code>data</code> and cannot change during a simulation. The FMU takes both as inputs.</li>
<li>Side 2 does not rotate: only the FMU has rotations, moments and contact pressures.</li>
<li>The FMU has separate sliders on each friction patch. At a small fraction of the friction limit, where few of them slip, the energy losses of component and FMU differ. In free vibration with partial slip, their displacements differ by 1 to 4 %: for smaller errors use the FMU in its wrapper.</li>
<li>The normal dissipation factor is interpolated linearly, within 0.001.</li>
<li>The table ends at 10 times the total preload; beyond, the last tangent continues without a warning. With side 2 lifted off, only the stiffness n k of the bolts remains.</li>
</ul>
<h4>How far to trust it</h4>
<ul>
<li><b>Not validated as a stiffness.</b> The paper publishes no stiffness of the joint. What agrees are the contact pressures at the bolt and between two bolts (which calibrate the pressure field), the bolt forces under the moment, and the paper's own intermediate numbers.</li>
<li><b>Estimates.</b> Size of the frame, nominal area <code>A_0</code>, mass, friction and traction ratio are not published. The stiffness depends on <code>A_0</code>: 72 kN over the published pressures bounds it to 0.009 to 0.116 m².</li>
<li><b>Critical area.</b> The printed Eq. 4 makes the force of a spot jump. The default is the area without a jump; the printed one gives a stiffness 6 times lower, the onset of yield one 37 times lower.</li>
<li><b>Closing contact.</b> Below 4 kPa (default parameters) the law gives almost no stiffness; the curve continues smoothly to zero and departs from the law.</li>
<li><b>Normal damping is off.</b> η<sub>n</sub> is the plastic work of first loading. A joint in service has been loaded before and does not dissipate this work again in each vibration; <code>plastic_damping</code> = true activates the paper's value.</li>
<li><b>Trend.</b> An elastic boundary-element solution of rough surfaces finds a stiffness close to proportional to the pressure and hardly dependent on D. The fractal law has lower powers of the pressure, which depend on D.</li>
<li><b>Range.</b> After separation only the stiffness of the bolts remains. If the mean pressure exceeds the hardness, the curve continues with its last tangent. If a moment would need a negative bolt force, the contact opens there and a warning is logged.</li>
<li><b>Not included:</b> rotation of side 2, the compliance of the clamped members, bending of the flanges, shear of the bolts, wear, increase of the friction with time at rest. Damping is the viscous equivalent at the resonance of <code>mass</code>.</li>
</ul>
<p>Y. Zhao, C. Yang, L. Cai, W. Shi, Y. Hong: <em>Stiffness and Damping Model of Bolted Joints with Uneven Surface Contact Pressure Distribution.</em> 2018.</p>
</html>"));
end BoltedJoint;
