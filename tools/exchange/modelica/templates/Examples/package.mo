within JointStiffness;
package Examples "Systems to open and run"
  extends Modelica.Icons.ExamplesPackage;
end Examples;
