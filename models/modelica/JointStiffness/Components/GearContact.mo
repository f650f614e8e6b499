within JointStiffness.Components;
model GearContact "Contact of two rough tooth flanks along their normal"
  extends Modelica.Mechanics.Translational.Interfaces.PartialCompliant;
  parameter JointStiffness.Data.GearContact data = JointStiffness.Data.Beveloid_gear_of_Yu_2022() "The contact"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Distance s_rel0=0 "Distance of the flanges at first touch";
  Modelica.Units.SI.Position approach(nominal=1e-6) "approach of the two flanks, counted from first touch, negative while separated";
  Modelica.Units.SI.TranslationalSpringConstant K_N(nominal=1e9) "Tangent stiffness";
equation
  approach = s_rel0 - s_rel;
  f = -JointStiffness.Functions.load(approach, data.table);
  K_N = JointStiffness.Functions.stiffness(approach, data.table);
  annotation (
    defaultComponentName="gearContact",
    Icon(graphics={
      Polygon(points={{-90,-60},{-90,60},{-30,60},{-6,20},{-6,-20},{-30,-60},{-90,-60}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Polygon(points={{90,60},{90,-60},{30,-60},{6,-20},{6,20},{30,60},{90,60}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{0,24},{-4,16},{4,8},{-4,0},{4,-8},{-4,-16},{0,-24}}, color={209,67,43}, thickness=0.75),
      Text(extent={{-150,110},{150,70}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The contact of two rough tooth flanks under a normal load.  Asperities are elliptical. The pressure is uniform over the nominal area <code>A_0</code>.</p>
<h4>Flanges</h4>
<p>The flanks touch when flange_b is <code>s_rel0</code> from flange_a and a compressive force acts when they come closer; separated flanks have no force. The law has no damping.</p>
<h4>Law</h4>
<p>s<sub>rel</sub>(f) = ∫<sub>0</sub><sup>f</sup> df′ / K<sub>N</sub>(f′), &emsp; p = f/A<sub>0</sub></p>
<p>Load, stiffness and areas are sums over contact spots of real area a, up to the largest one, a<sub>l</sub>, whose load is f:</p>
<p>n(a) = λ q a<sub>l</sub><sup>q</sup> a<sup>−q−1</sup>, &emsp; q = ½ ζ (D<sub>1</sub> + D<sub>2</sub>), &emsp; ζ = ½ (1 − e<sup>2</sup>)<sup>1/2</sup> (Yu 2022, Eqs. 42-46)</p>
<p>f = ∫ F(a) n da, &emsp; K<sub>N</sub> = ∫ k(a) n da, &emsp; A<sub>r</sub> = ∫ a n da (Eqs. 54-79, corrected)</p>
<p>Small spots are sharp and plastic; with growing area a spot passes the second and the first elastic-plastic stage and becomes elastic beyond a<sub>nec</sub>:</p>
<p>a<sub>nec</sub> (1/R<sub>x</sub> + 1/R<sub>y</sub>)<sup>2</sup> = 4π f<sub>1</sub> K(e) E(e) (k H/E′)<sup>2</sup>, &emsp; H = 2.8 σ<sub>y</sub> (Eqs. 25, 28, corrected)</p>
<p>1/R<sub>x</sub> = 2<sup>4−D₁</sup> π<sup>D₁/2</sup> G<sub>1</sub><sup>D₁−1</sup> (ln γ)<sup>1/2</sup> (1 − e<sup>2</sup>)<sup>D₁/4</sup> a<sup>−D₁/2</sup>, &emsp; 1/R<sub>y</sub> with D<sub>2</sub>, G<sub>2</sub>, (1 − e<sup>2</sup>)<sup>−D₂/4</sup> (Eqs. 12, 13)</p>
<p>elastic: F = (2/3) f<sub>2</sub> E′ (1/R<sub>x</sub> + 1/R<sub>y</sub>) (a/(π f<sub>1</sub>))<sup>3/2</sup>, &emsp; k = 2 f<sub>2</sub> E′ (a/(π f<sub>1</sub>))<sup>1/2</sup> (Eqs. 22-24, 75)</p>
<p>The elastic-plastic stages are the fits of Kogut and Etsion for the curvature of the spot (Eqs. 33-36); a plastic spot carries H a (Eq. 38). f<sub>1</sub> and f<sub>2</sub> are shape factors of the ellipse, 1 for e = 0.</p>
<h4>Not in this table</h4>
<p>Real area and its elastic part are outputs of the FMU only. The table ends where the mean pressure reaches the hardness, 65.8 kN; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<ul>
<li><b>Not validated as a stiffness.</b> The paper prints no numbers of its curves. What is compared are its claims: three of them contradict its own equations (at a given real area the elastic load rises with G and falls with D, and the elastic share depends on the eccentricity).</li>
<li><b>Estimates.</b> The nominal area <code>A_0</code> and <code>surface.gamma</code> are not published; the contact coefficient <code>lambda</code> is an input, because the printed one depends on the unit of length.</li>
<li><b>Closing contact.</b> Below 21 kPa (2 N with the default parameters) the law gives almost no stiffness; the curve continues smoothly to zero and departs from the law.</li>
<li><b>Elastic-plastic spots.</b> With the default <code>plastic_area</code>, geometric, the mean pressure of a spot overshoots the hardness by up to 1.8; the alternative makes the contact 27 % stiffer at 20 MPa.</li>
<li><b>Trend.</b> An elastic boundary-element solution of rough surfaces finds a stiffness close to proportional to the pressure and hardly dependent on D. The fractal law has lower powers of the pressure, which depend on D.</li>
<li><b>Range.</b> The table ends where the mean pressure reaches the hardness.</li>
<li><b>Not included:</b> bending of the teeth, lubrication, sliding, damping, change of the contact along the path of action.</li>
</ul>
<p>G. Yu, H. Mao, L. Jiang, W. Liu, T. Valerii: <em>Fractal Contact Mechanics Model for the Rough Surface of a Beveloid Gear with Elliptical Asperities.</em> Applied Sciences 12, 4071, 2022. <a href=\"https://doi.org/10.3390/app12084071\">doi:10.3390/app12084071</a></p>
</html>"));
end GearContact;
