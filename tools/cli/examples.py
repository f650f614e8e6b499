"""Examples for the help texts, one for each command. The tests run them."""

EXAMPLES = {
    "new": "new bolted-joint --plate 200x100 --bolts 4xM12 --at 160x60 --grip 40 "
    "--material steel --Ra 0.8 --out plate.toml",
    "new materials": "new materials",
    "new finishes": "new finishes",
    "new bolts": "new bolts",
    "catalogue": "catalogue CSG-17",
    "law": "law zhao2018 --pressure 1e6 2e6",
    "parameters": "parameters HarmonicDriveSpring",
    "build": "build GearContact --flavour fmi2 --out dist",
    "cache": "cache",
    "modelica": "modelica --preload 20e3 --out modelica",
    "export": "export calculix springs --preload 9e3 --units mm-N-MPa-t --out springs.inp",
    "footprint": "footprint compute models/assemblies/box_specimen.toml --refinement 0.35",
    "footprint import": "footprint import my_field.csv --preload 9000 --out with_field.toml",
    "footprint compute": "footprint compute models/assemblies/box_specimen.toml --refinement 0.35",
    "modes": "modes models/assemblies/box_specimen.toml --refinement 0.35",
    "report": "report my_joint.toml --out my_joint.html",
    "ramp": "ramp dist/fmi2/GearContact.fmu --input f --to 1000 --step 10 --csv ramp.csv",
    "prove": "prove dist/fmi2/GearContact.fmu",
    "ring": "ring robot_joint --fmus dist/fmi2 --load 0 2.5 --csv ring.csv",
    "system": "system six_axis_robot --plot tip.png",
    "robot": "robot my_robot.xml --drive joint2=CSG-40-100 joint3=CSG-25-100 --out robot",
    "surface": "surface scan.csv --side both --joint harmonic_drive --out my_drive.toml",
    "surface identify": "surface identify scan.csv --side both --joint harmonic_drive --out my_drive.toml",
    "surface synthesize": "surface synthesize --size 1e-3 --points 400 --D 2.53 --G 2.4e-7 --out scan.csv",
    "fit": "fit catalogue --K1 4700 --K2 6100 --K3 7100 --T1 2 --T2 6.9 --out drive.toml",
    "fit catalogue": "fit catalogue --K1 4700 --K2 6100 --K3 7100 --T1 2 --T2 6.9 --out drive.toml",
    "fit torque-angle": "fit torque-angle loop.csv --out drive.toml",
    "fit loop": "fit loop shear.csv --preload 9e3 --free mu surface.G --out joint.toml",
    "fit log": "fit log robot.csv --drive CSG-25-100 --torque-constant 0.1 --out drive.toml",
    "fit system": "fit system arm.toml record.csv --free motor.J link.J drive.K1 drive.d --hold-out 0.2 "
    "--out fitted_arm.toml",
    "fit preload": "fit preload stiffness.csv --params my_joint.toml --out joint.toml",
    "uncertainty": "uncertainty gear_contact --set e=0.1..0.3 --samples 1024",
    "sweep": "sweep dist/fmi2/GearContact.fmu --set e=0.1..0.3 --input f --to 1000 --step 100 "
    "--samples 8 --out sweep",
    "validate": "validate",
}
"""{command: example}, both without the word `jointfmu`."""

EXAMPLE_PREREQUISITES = {
    "ramp": "after jointfmu build GearContact",
    "prove": "after jointfmu build GearContact",
    "sweep": "after jointfmu build GearContact",
    "ring": "after jointfmu build --systems",
}
"""{command: command that must run before its example}."""
