within JointStiffness.Data;
record GearMesh "A pair of gear wheels"
  extends Modelica.Icons.Record;
  parameter Modelica.Units.SI.Length r_b1(min=Modelica.Constants.small) "<< meta.r_b1 >>";
  parameter Modelica.Units.SI.Length r_b2(min=Modelica.Constants.small) "<< meta.r_b2 >>";
  parameter Real teeth1(min=1) "<< meta.teeth1 >>";
  parameter Modelica.Units.SI.Length backlash(min=0) "<< meta.backlash >>";
  parameter Real contact_ratio(min=1) "<< meta.contact_ratio >>";
  parameter Real engagement(min=Modelica.Constants.small, max=1) "<< meta.engagement >>";
  parameter Modelica.Units.SI.TranslationalDampingConstant d(min=0) "<< meta.d >>";
  parameter Real overlap_ratio(min=0) = 0 "<< meta.overlap_ratio >>";
  parameter Modelica.Units.SI.Length closing "Deflection of a tooth pair at which the closing of its contact ends";
  parameter Real energy[:] "Energy of a tooth pair at each node of the table [J]";
  parameter Real table[:, 5]
    "Deflection of a tooth pair [m], force [N], stiffness [N/m], its derivative before and after [N/m2]";
end GearMesh;
