within JointStiffness;
package Wrappers "Imported FMUs between flanges"
  extends Modelica.Icons.Package;
  annotation (Documentation(info="<html>
<p>Import the FMU, put the wrapper of its name into your model and redeclare <code>fmu</code>, for instance</p>
<pre>JointStiffness.Wrappers.<< example >> joint(
  redeclare << example >>_fmu fmu);</pre>
<p>where <code><< example >>_fmu</code> is the class that your tool created from the FMU.</p>
<h4>Sign</h4>
<p>The FMUs give the force that the joint applies to its neighbour. The flow signal of the adaptors of the Modelica Standard Library is the force that the neighbour applies to the joint. Every wrapper therefore contains a gain of -1 on each force; without it the spring would push instead of pull.</p>
</html>"));
end Wrappers;
