within JointStiffness.Data;
record GearMesh "A pair of gear wheels"
  extends Modelica.Icons.Record;
  parameter Modelica.Units.SI.Length r_b1(min=Modelica.Constants.small) "base radius of wheel 1";
  parameter Modelica.Units.SI.Length r_b2(min=Modelica.Constants.small) "base radius of wheel 2";
  parameter Real teeth1(min=1) "number of teeth of wheel 1";
  parameter Modelica.Units.SI.Length backlash(min=0) "backlash along the line of action";
  parameter Real contact_ratio(min=1) "mean number of tooth pairs in contact";
  parameter Real engagement(min=Modelica.Constants.small, max=1) "time over which a pair takes up its load, divided by the shorter of the times with and without the pair";
  parameter Modelica.Units.SI.TranslationalDampingConstant d(min=0) "damping along the line of action while the flanks touch";
  parameter Real overlap_ratio(min=0) = 0 "overlap ratio: face width divided by axial pitch; 0: spur gears";
  parameter Modelica.Units.SI.Length closing "Deflection of a tooth pair at which the closing of its contact ends";
  parameter Real energy[:] "Energy of a tooth pair at each node of the table [J]";
  parameter Real table[:, 5]
    "Deflection of a tooth pair [m], force [N], stiffness [N/m], its derivative before and after [N/m2]";
end GearMesh;
