within JointStiffness.Data;
record BoltedJoint "A bolted joint at a fixed preload, moment and temperature"
  extends Modelica.Icons.Record;
  parameter Modelica.Units.SI.Force preload(min=0) "Preload of each bolt (bolt force at tightening)";
  parameter Modelica.Units.SI.Torque moment "Bending moment on the joint";
  parameter Modelica.Units.SI.Temperature temperature=293.15 "Temperature of bolts and members; tightened at 293.15 K";
  parameter Modelica.Units.SI.Mass mass(min=0) "<< meta.mass >>";
  parameter Modelica.Units.SI.TranslationalSpringConstant bolts(min=0) "Stiffness of all bolts, parallel to the interface";
  parameter Modelica.Units.SI.Force bolt_forces[:](each min=0) "Force of each bolt at tightening; all bolts have an equal share of the stiffness";
  parameter Boolean plastic_damping = false "<< meta.plastic_damping >>";
  parameter Boolean memory = true "<< meta.memory >>";
  parameter Boolean damping = false "<< meta.damping >>";
  parameter Real mu(min=0) "<< meta.mu >>";
  parameter Modelica.Units.SI.Force tight(min=0) "Normal force of the tightened interface";
  parameter Real shear(min=0) "Ratio of tangential to normal stiffness";
  parameter Real eta_t(min=0) "Tangential dissipation factor";
  parameter Real table[:, 5]
    "Approach from the tightened state [m], force above tightening [N], stiffness [N/m], its derivative before and after [N/m2]";
  parameter Real heights[:, 3]
    "Approach from the tightened state [m], normal force [N] and stiffness [N/m]; the springs of a slider lie between two rows";
  parameter Real sliders[:, 2]
    "Stiffness [N/m] and friction limit [N] of the sliders at tightening; those that slip first come first";
  parameter Real eta_n[:, 2] "Approach from the tightened state [m], normal dissipation factor";
end BoltedJoint;
