within JointStiffness;
package Interfaces "Inputs and outputs of the FMUs"
  extends Modelica.Icons.InterfacesPackage;
  annotation (Documentation(info="<html>
<p>One partial block per FMU with exactly its inputs and outputs. An imported FMU can replace it.</p>
</html>"));
end Interfaces;
