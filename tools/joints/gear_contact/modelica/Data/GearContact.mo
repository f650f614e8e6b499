within JointStiffness.Data;
record GearContact "The tooth contact of a gear"
  extends Modelica.Icons.Record;
  parameter Real table[:, 5]
    "Approach from first touch [m], force [N], stiffness [N/m], its derivative before and after [N/m2]";
end GearContact;
