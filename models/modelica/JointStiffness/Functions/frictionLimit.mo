within JointStiffness.Functions;
function frictionLimit "Limit of dry friction that a load raises, on one side"
  extends Modelica.Icons.Function;
  input Real unloaded "Limit without load";
  input Real load_loss "Share of the load that friction against it has";
  input Real loss_back "Share of the load that friction which holds it has";
  input Real tau "Torque at the output";
  input Real width "Torque within which the load's size is smooth";
  input Real ratio "Speed ratio; of negative friction the other sign";
  output Real limit "Limit";
protected
  Real turned "Sign of the torque, smooth";
algorithm
  turned := tanh(tau/width);
  limit := unloaded + (load_loss + (loss_back - load_loss)*0.5*(1 + turned*ratio/abs(ratio)))*tau*turned/abs(ratio);
  annotation (Inline=true);
end frictionLimit;
