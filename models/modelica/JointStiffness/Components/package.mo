within JointStiffness;
package Components "Joints with flanges; no FMU needed"
  extends Modelica.Icons.Package;
  annotation (Documentation(info="<html>
<p>Each component contains the exported curve of its joint as a table. For the drive with a locked wave generator (the FMU <code>HarmonicDriveCompliance</code>) fix <code>flange_a</code> of <a href=\"modelica://JointStiffness.Components.HarmonicDriveSpring\">HarmonicDriveSpring</a>: an acausal component is its own inverse. With <code>d</code> = 0 and no inertia set <code>use_damping=false</code>.</p>
</html>"));
end Components;
