within ;
package Modelica "Stand-in for the Modelica Standard Library 4.0.0: only what JointStiffness uses"
  // Written for the tests, where the library itself is not at hand. Names, types, signs and equations of
  // the connectors, adaptors, inertias and sources are the library's; graphics and options are left out.

  package Icons
    partial package Package end Package;
    partial package FunctionsPackage end FunctionsPackage;
    partial package RecordsPackage end RecordsPackage;
    partial package InterfacesPackage end InterfacesPackage;
    partial package ExamplesPackage end ExamplesPackage;
    partial model Example end Example;
    partial function Function end Function;
    partial record Record end Record;
  end Icons;

  package Constants
    constant Real pi = 3.14159265358979323846;
    constant Real small = 1e-60;
    constant Real g_n(unit="m/s2") = 9.80665;
  end Constants;

  package Units
    package SI
      type Time = Real(quantity="Time", unit="s");
      type Angle = Real(quantity="Angle", unit="rad");
      type AngularVelocity = Real(quantity="AngularVelocity", unit="rad/s");
      type AngularAcceleration = Real(quantity="AngularAcceleration", unit="rad/s2");
      type Length = Real(quantity="Length", unit="m");
      type Position = Length;
      type Distance = Length(min=0);
      type Velocity = Real(quantity="Velocity", unit="m/s");
      type Acceleration = Real(quantity="Acceleration", unit="m/s2");
      type Mass = Real(quantity="Mass", unit="kg", min=0);
      type Inertia = Real(quantity="MomentOfInertia", unit="kg.m2");
      type Force = Real(quantity="Force", unit="N");
      type Torque = Real(quantity="Torque", unit="N.m");
      type Energy = Real(quantity="Energy", unit="J");
      type Power = Real(quantity="Power", unit="W");
      type HeatFlowRate = Real(quantity="Power", unit="W");
      type ThermodynamicTemperature = Real(quantity="ThermodynamicTemperature", unit="K", min=0, start=288.15, nominal=300);
      type Temperature = ThermodynamicTemperature;
      type LinearTemperatureCoefficient = Real(quantity="LinearTemperatureCoefficient", unit="1/K");
      type RotationalSpringConstant = Real(quantity="RotationalSpringConstant", unit="N.m/rad");
      type RotationalDampingConstant = Real(quantity="RotationalDampingConstant", unit="N.m.s/rad");
      type TranslationalSpringConstant = Real(quantity="TranslationalSpringConstant", unit="N/m");
      type TranslationalDampingConstant = Real(quantity="TranslationalDampingConstant", unit="N.s/m");
    end SI;
  end Units;

  package Blocks
    package Icons
      partial block Block end Block;
    end Icons;

    package Interfaces
      connector RealInput = input Real;
      connector RealOutput = output Real;

      partial block SO
        RealOutput y;
      end SO;

      package Adaptors
        partial model FlowToPotentialAdaptor
          parameter Boolean use_pder = true;
          parameter Boolean use_pder2 = true;
          RealOutput p;
          RealOutput pder if use_pder;
          RealInput f;
        protected
          Real y;
          RealOutput y1;
          Real u;
        equation
          y = p;
          y1 = if use_pder then der(y) else 0;
          connect(y1, pder);
          u = f;
        end FlowToPotentialAdaptor;

        partial model PotentialToFlowAdaptor
          parameter Boolean use_pder = true;
          parameter Boolean use_pder2 = true;
          RealInput p;
          RealOutput f;
        protected
          Real y;
          Real u;
        equation
          y = -f;
          u = p;
        end PotentialToFlowAdaptor;
      end Adaptors;
    end Interfaces;

    package Math
      block Gain
        parameter Real k(start=1);
        Interfaces.RealInput u;
        Interfaces.RealOutput y;
      equation
        y = k*u;
      end Gain;
    end Math;
  end Blocks;

  package Thermal
    package HeatTransfer
      package Interfaces
        connector HeatPort_a
          Units.SI.Temperature T;
          flow Units.SI.HeatFlowRate Q_flow;
        end HeatPort_a;
      end Interfaces;
    end HeatTransfer;
  end Thermal;

  package Mechanics
    package Rotational
      package Interfaces
        connector Flange_a
          Units.SI.Angle phi;
          flow Units.SI.Torque tau;
        end Flange_a;
        connector Flange_b
          Units.SI.Angle phi;
          flow Units.SI.Torque tau;
        end Flange_b;
      end Interfaces;

      package Components
        model Fixed
          parameter Units.SI.Angle phi0 = 0;
          Interfaces.Flange_b flange;
        equation
          flange.phi = phi0;
        end Fixed;

        model Inertia
          Interfaces.Flange_a flange_a;
          Interfaces.Flange_b flange_b;
          parameter Units.SI.Inertia J(min=0, start=1);
          Units.SI.Angle phi;
          Units.SI.AngularVelocity w;
          Units.SI.AngularAcceleration a;
        equation
          phi = flange_a.phi;
          phi = flange_b.phi;
          w = der(phi);
          a = der(w);
          J*a = flange_a.tau + flange_b.tau;
        end Inertia;

        model GeneralTorqueToAngleAdaptor
          extends Blocks.Interfaces.Adaptors.FlowToPotentialAdaptor;
          Rotational.Interfaces.Flange_a flange;
        equation
          y = flange.phi;
          u = flange.tau;
        end GeneralTorqueToAngleAdaptor;

        model GeneralAngleToTorqueAdaptor
          extends Blocks.Interfaces.Adaptors.PotentialToFlowAdaptor;
          Rotational.Interfaces.Flange_b flange;
        equation
          y = flange.tau;
          u = flange.phi;
        end GeneralAngleToTorqueAdaptor;
      end Components;

      package Sources
        model Torque
          Interfaces.Flange_b flange;
          Blocks.Interfaces.RealInput tau;
        equation
          flange.tau = -tau;
        end Torque;
      end Sources;
    end Rotational;

    package Translational
      package Interfaces
        connector Flange_a
          Units.SI.Position s;
          flow Units.SI.Force f;
        end Flange_a;
        connector Flange_b
          Units.SI.Position s;
          flow Units.SI.Force f;
        end Flange_b;
        partial model PartialCompliant
          Flange_a flange_a;
          Flange_b flange_b;
          Units.SI.Position s_rel(start=0);
          Units.SI.Force f;
        equation
          s_rel = flange_b.s - flange_a.s;
          flange_b.f = f;
          flange_a.f = -f;
        end PartialCompliant;
      end Interfaces;

      package Components
        model Fixed
          parameter Units.SI.Position s0 = 0;
          Interfaces.Flange_b flange;
        equation
          flange.s = s0;
        end Fixed;

        model Mass
          parameter Units.SI.Mass m(min=0, start=1);
          parameter Units.SI.Length L(start=0) = 0;
          Interfaces.Flange_a flange_a;
          Interfaces.Flange_b flange_b;
          Units.SI.Position s(start=0);
          Units.SI.Velocity v(start=0);
          Units.SI.Acceleration a(start=0);
        equation
          flange_a.s = s - L/2;
          flange_b.s = s + L/2;
          v = der(s);
          a = der(v);
          m*a = flange_a.f + flange_b.f;
        end Mass;

        model GeneralForceToPositionAdaptor
          extends Blocks.Interfaces.Adaptors.FlowToPotentialAdaptor;
          Translational.Interfaces.Flange_a flange;
        equation
          y = flange.s;
          u = flange.f;
        end GeneralForceToPositionAdaptor;

        model GeneralPositionToForceAdaptor
          extends Blocks.Interfaces.Adaptors.PotentialToFlowAdaptor;
          Translational.Interfaces.Flange_b flange;
        equation
          y = flange.f;
          u = flange.s;
        end GeneralPositionToForceAdaptor;
      end Components;

      package Sources
        model Force
          Interfaces.Flange_b flange;
          Blocks.Interfaces.RealInput f;
        equation
          flange.f = -f;
        end Force;
      end Sources;
    end Translational;
  end Mechanics;
  annotation (version="4.0.0");
end Modelica;
