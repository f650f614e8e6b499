within JointStiffness.Data;
record BoltedJoint "A bolted joint at a fixed preload and moment"
  extends Modelica.Icons.Record;
  parameter Modelica.Units.SI.Force preload(min=0) "Pre-tightening force of each bolt";
  parameter Modelica.Units.SI.Torque moment "Bending moment on the joint";
  parameter Modelica.Units.SI.Mass mass(min=0) "<< meta.mass >>";
  parameter Real shear(min=0) "Tangential over normal stiffness";
  parameter Real eta_t(min=0) "Tangential dissipation factor";
  parameter Real table[:, 5]
    "Approach from the tightened state [m], force above tightening [N], stiffness [N/m], its derivative before and after [N/m2]";
  parameter Real damping[:, 2] "Approach from the tightened state [m], normal dissipation factor";
end BoltedJoint;
