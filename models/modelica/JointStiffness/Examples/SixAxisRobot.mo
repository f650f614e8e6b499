within JointStiffness.Examples;
model SixAxisRobot "Robot with six axes"
  extends Modelica.Icons.Example;

  record Base_driveData "CSG-32-100, of base_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=28,
      final rated_torque=178,
      final friction_coulomb=0.116207093879245,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=0.00134380951441182,
      final load_loss=0.112016018136728,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=240000,
      final hysteresis_friction=9.815204504,
      final hysteresis_stiffness=67000,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 67000, 0, 0;
      0.0004155223881, 27.84, 67000, 0, 0;
      0.0004501492537, 30.90447761, 110000, 0, 0;
      0.001104976934, 102.9355224, 110000, 0, 0;
      0.001197058345, 113.5248847, 120000, 0, 0;
      0.003859350972, 433, 120000, 0, 0]);
  end Base_driveData;

  record Shoulder_driveData "CSG-40-100, of shoulder_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=41,
      final rated_torque=345,
      final friction_coulomb=0.185875858462628,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=0.00282082361224348,
      final load_loss=0.112016018136728,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=460000,
      final hysteresis_friction=18.99504381,
      final hysteresis_stiffness=130000,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 130000, 0, 0;
      0.0003987692308, 51.84, 130000, 0, 0;
      0.000432, 57.32307692, 200000, 0, 0;
      0.001080369231, 186.9969231, 200000, 0, 0;
      0.0011704, 206.3535385, 230000, 0, 0;
      0.003481906355, 738, 230000, 0, 0]);
  end Shoulder_driveData;

  record Elbow_driveData "CSG-25-100, of elbow_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=11,
      final rated_torque=87,
      final friction_coulomb=0.0691132698793958,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=0.00057535889867951,
      final load_loss=0.112016018136729,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=114000,
      final hysteresis_friction=4.525004676,
      final hysteresis_stiffness=31000,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 31000, 0, 0;
      0.0004335483871, 13.44, 31000, 0, 0;
      0.0004696774194, 14.90322581, 50000, 0, 0;
      0.001086348387, 45.73677419, 50000, 0, 0;
      0.001176877419, 50.58007742, 57000, 0, 0;
      0.003868455008, 204, 57000, 0, 0]);
  end Elbow_driveData;

  record Forearm_driveData "CSG-20-100, of forearm_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=1.3,
      final rated_torque=52,
      final friction_coulomb=0.0432086894317765,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=0.000257233137586905,
      final load_loss=0.112016018136728,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=58000,
      final hysteresis_friction=2.32769437,
      final hysteresis_stiffness=16000,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 16000, 0, 0;
      0.00042, 6.72, 16000, 0, 0;
      0.000455, 7.4375, 25000, 0, 0;
      0.0011112, 23.8425, 25000, 0, 0;
      0.0012038, 26.3427, 29000, 0, 0;
      0.003985086207, 107, 29000, 0, 0]);
  end Forearm_driveData;

  record Wrist_driveData "CSG-17-100, of wrist_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=1.5,
      final rated_torque=31,
      final friction_coulomb=0.0306903429827406,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=0.0001381355604506,
      final load_loss=0.112016018136729,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=32000,
      final hysteresis_friction=1.453788876,
      final hysteresis_stiffness=10000,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 10000, 0, 0;
      0.0003744, 3.744, 10000, 0, 0;
      0.0004056, 4.1184, 14000, 0, 0;
      0.0009298285714, 11.4576, 14000, 0, 0;
      0.001007314286, 12.61988571, 16000, 0, 0;
      0.004593571429, 70, 16000, 0, 0]);
  end Wrist_driveData;

  record Hand_driveData "CSG-14-100, of hand_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=-100,
      final d=0.16,
      final rated_torque=10,
      final friction_coulomb=0.020394395098597,
      final friction_stribeck=0,
      final stribeck_speed=10,
      final friction_viscous=6.1617961716082e-05,
      final load_loss=0.112016018136728,
      final load_loss_back=0.0611929947570491,
      final friction_1=0,
      final friction_1_phase=0,
      final friction_2=0,
      final friction_2_phase=0,
      final presliding=0.01,
      final temperature_factor=1,
      final viscous_temperature_coefficient=0.023,
      final dry_temperature_coefficient=0.01,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final T=293.15,
      final K_FTS0=14200,
      final hysteresis_friction=0.6925001349,
      final hysteresis_stiffness=4700,
      final sliders=[
      0.006432632441, 2.073388569e-05;
      0.006937153831, 6.904270186e-05;
      0.007478653141, 0.0001290783906;
      0.008059377818, 0.0002030613874;
      0.008681624399, 0.0002935890185;
      0.009347719894, 0.0004036939323;
      0.01005999795, 0.0005369104237;
      0.01082076886, 0.0006973493838;
      0.01163228219, 0.0008897825648;
      0.01249668075, 0.001119736748;
      0.01341594443, 0.001393598219;
      0.01439182199, 0.001718727679;
      0.01542574897, 0.002103585272;
      0.01651874933, 0.002557864778;
      0.01767131835, 0.003092635141;
      0.01888328383, 0.003720486198;
      0.0201536425, 0.004455673784;
      0.02148036809, 0.005314256995;
      0.02286018736, 0.006314217204;
      0.02428832006, 0.007475544156;
      0.02575817886, 0.008820268753;
      0.02726102503, 0.01037241458;
      0.02878557647, 0.0121578303;
      0.03031756483, 0.01420385182;
      0.03183924029, 0.01653872616;
      0.03332882447, 0.01919070633;
      0.03475991542, 0.02218669759;
      0.03610085393, 0.02555029742;
      0.03731406817, 0.02929902297;
      0.03835542561, 0.03344045672;
      0.03917363795, 0.03796696112;
      0.03970979114, 0.04284851121;
      0.03989710997, 0.04802306756;
      0.03966112491, 0.05338375759;
      0.03892049654, 0.05876195275;
      0.03758889187, 0.06390513831;
      0.03557853171, 0.06844831801;
      0.03280641042, 0.07187771235;
      0.02920488088, 0.07348607077;
      0.02473965383, 0.07232111587;
      0.01944125577, 0.06713602917;
      0.01346381551, 0.05637728116;
      0.007211895049, 0.03836322143;
      0.00174555519, 0.01283102219],
      final table=[
      0, 0, 4700, 0, 0;
      0.0004085106383, 1.92, 4700, 0, 0;
      0.0004425531915, 2.103829787, 6100, 0, 0;
      0.001179658179, 6.600170213, 6100, 0, 0;
      0.001277963028, 7.248982211, 7100, 0, 0;
      0.005327402153, 36, 7100, 0, 0]);
  end Hand_driveData;

  JointStiffness.Components.AngleProfile base_motor(start=0.1, duration=1, height=-122.2)
    annotation (Placement(transformation(extent={{-90,70},{-70,90}})));
  JointStiffness.Components.HarmonicDriveSpring base_drive(data=Base_driveData(), hysteresis_friction=9.815204504, hysteresis_stiffness=67000)
    annotation (Placement(transformation(extent={{-30,70},{-10,90}})));
  Modelica.Mechanics.Rotational.Components.Inertia base_link(J=7.40718819165282, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,70},{50,90}})));
  JointStiffness.Components.TorqueCurve base_load(start=0.1, duration=1, p={0, 33.41272944, 53.77335739, 63.27751978, 44.46427224, 144.73957609, -282.36446663, 748.13069055, -1502.38433012, 1205.32670067, -748.18709252, 347.22481868, -121.71798362, 25.046662, -8.75270292, -1.98784148, 0})
    annotation (Placement(transformation(extent={{90,70},{110,90}})));
  Modelica.Mechanics.Rotational.Sources.Torque base_load_tau
    annotation (Placement(transformation(extent={{120,70},{140,90}})));
  JointStiffness.Components.AngleProfile shoulder_motor(start=0.1, duration=1, height=-87.27)
    annotation (Placement(transformation(extent={{-90,40},{-70,60}})));
  JointStiffness.Components.HarmonicDriveSpring shoulder_drive(data=Shoulder_driveData(), hysteresis_friction=18.99504381, hysteresis_stiffness=130000)
    annotation (Placement(transformation(extent={{-30,40},{-10,60}})));
  Modelica.Mechanics.Rotational.Components.Inertia shoulder_link(J=8.14835487753431, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,40},{50,60}})));
  JointStiffness.Components.TorqueCurve shoulder_load(start=0.1, duration=1, p={0, -30.73709333, -48.91810652, -55.71093232, -33.75887074, -62.8490004, 124.49246171, -165.6406545, 556.60006176, -109.3565435, 345.71056877, 86.47705917, 172.01464114, 133.98621159, 137.98808477, 129.54565535, 117.32029263})
    annotation (Placement(transformation(extent={{90,40},{110,60}})));
  Modelica.Mechanics.Rotational.Sources.Torque shoulder_load_tau
    annotation (Placement(transformation(extent={{120,40},{140,60}})));
  JointStiffness.Components.AngleProfile elbow_motor(start=0.1, duration=1, height=-104.7)
    annotation (Placement(transformation(extent={{-90,10},{-70,30}})));
  JointStiffness.Components.HarmonicDriveSpring elbow_drive(data=Elbow_driveData(), hysteresis_friction=4.525004676, hysteresis_stiffness=31000)
    annotation (Placement(transformation(extent={{-30,10},{-10,30}})));
  Modelica.Mechanics.Rotational.Components.Inertia elbow_link(J=2.23554092189438, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,10},{50,30}})));
  JointStiffness.Components.TorqueCurve elbow_load(start=0.1, duration=1, p={0, -17.74522872, -28.43417588, -31.39268635, -22.50035874, -31.09816833, 65.15036668, -109.67788494, 321.35289081, -158.80461687, 203.67503592, 4.41936865, 88.45182102, 59.58488762, 62.46244638, 55.35465313, 45.19978655})
    annotation (Placement(transformation(extent={{90,10},{110,30}})));
  Modelica.Mechanics.Rotational.Sources.Torque elbow_load_tau
    annotation (Placement(transformation(extent={{120,10},{140,30}})));
  JointStiffness.Components.AngleProfile forearm_motor(start=0.1, duration=1, height=78.54)
    annotation (Placement(transformation(extent={{-90,-20},{-70,0}})));
  JointStiffness.Components.HarmonicDriveSpring forearm_drive(data=Forearm_driveData(), hysteresis_friction=2.32769437, hysteresis_stiffness=16000)
    annotation (Placement(transformation(extent={{-30,-20},{-10,0}})));
  Modelica.Mechanics.Rotational.Components.Inertia forearm_link(J=0.0697886093001334, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-20},{50,0}})));
  JointStiffness.Components.TorqueCurve forearm_load(start=0.1, duration=1, p={0, -0.24747729, -0.32702009, -0.63459911, -0.45672099, 2.42544643, -13.94523583, 35.74834952, -79.7185252, 72.57490892, -37.13054082, 29.2136315, 2.02573635, 11.26890728, 8.35609847, 6.76167576, 3.51842498})
    annotation (Placement(transformation(extent={{90,-20},{110,0}})));
  Modelica.Mechanics.Rotational.Sources.Torque forearm_load_tau
    annotation (Placement(transformation(extent={{120,-20},{140,0}})));
  JointStiffness.Components.AngleProfile wrist_motor(start=0.1, duration=1, height=-69.81)
    annotation (Placement(transformation(extent={{-90,-50},{-70,-30}})));
  JointStiffness.Components.HarmonicDriveSpring wrist_drive(data=Wrist_driveData(), hysteresis_friction=1.453788876, hysteresis_stiffness=10000)
    annotation (Placement(transformation(extent={{-30,-50},{-10,-30}})));
  Modelica.Mechanics.Rotational.Components.Inertia wrist_link(J=0.15, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-50},{50,-30}})));
  JointStiffness.Components.TorqueCurve wrist_load(start=0.1, duration=1, p={0, -4.843321, -7.87861785, -8.29439478, -7.38367011, -10.36456642, 26.74287789, -66.98867688, 161.2337765, -131.78726118, 90.60417238, -38.36028214, 17.14888526, -1.30610623, 2.65404273, 2.11647472, 2.38322264})
    annotation (Placement(transformation(extent={{90,-50},{110,-30}})));
  Modelica.Mechanics.Rotational.Sources.Torque wrist_load_tau
    annotation (Placement(transformation(extent={{120,-50},{140,-30}})));
  JointStiffness.Components.AngleProfile hand_motor(start=0.1, duration=1, height=-157.1)
    annotation (Placement(transformation(extent={{-90,-80},{-70,-60}})));
  JointStiffness.Components.HarmonicDriveSpring hand_drive(data=Hand_driveData(), hysteresis_friction=0.6925001349, hysteresis_stiffness=4700)
    annotation (Placement(transformation(extent={{-30,-80},{-10,-60}})));
  Modelica.Mechanics.Rotational.Components.Inertia hand_link(J=0.0032, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-80},{50,-60}})));
  JointStiffness.Components.TorqueCurve hand_load(start=0.1, duration=1, p={0, -0.00529945, -0.0076406, -0.01461713, 0.01207435, -0.07863067, 0.16847643, -0.30070171, 0.56496528, -0.260822, 0.16377099, -0.08829367, -0.02571448, -0.05589163, -0.04383153, -0.02784474, 0})
    annotation (Placement(transformation(extent={{90,-80},{110,-60}})));
  Modelica.Mechanics.Rotational.Sources.Torque hand_load_tau
    annotation (Placement(transformation(extent={{120,-80},{140,-60}})));
equation
  connect(base_load.y, base_load_tau.tau)
    annotation (Line(points={{100,80},{130,80}}));
  connect(shoulder_load.y, shoulder_load_tau.tau)
    annotation (Line(points={{100,50},{130,50}}));
  connect(elbow_load.y, elbow_load_tau.tau)
    annotation (Line(points={{100,20},{130,20}}));
  connect(forearm_load.y, forearm_load_tau.tau)
    annotation (Line(points={{100,-10},{130,-10}}));
  connect(wrist_load.y, wrist_load_tau.tau)
    annotation (Line(points={{100,-40},{130,-40}}));
  connect(hand_load.y, hand_load_tau.tau)
    annotation (Line(points={{100,-70},{130,-70}}));
  connect(base_motor.flange, base_drive.flange_a)
    annotation (Line(points={{-80,80},{-20,80}}));
  connect(base_drive.flange_b, base_link.flange_b)
    annotation (Line(points={{-20,80},{40,80}}));
  connect(base_load_tau.flange, base_link.flange_a)
    annotation (Line(points={{130,80},{40,80}}));
  connect(shoulder_motor.flange, shoulder_drive.flange_a)
    annotation (Line(points={{-80,50},{-20,50}}));
  connect(shoulder_drive.flange_b, shoulder_link.flange_b)
    annotation (Line(points={{-20,50},{40,50}}));
  connect(shoulder_load_tau.flange, shoulder_link.flange_a)
    annotation (Line(points={{130,50},{40,50}}));
  connect(elbow_motor.flange, elbow_drive.flange_a)
    annotation (Line(points={{-80,20},{-20,20}}));
  connect(elbow_drive.flange_b, elbow_link.flange_b)
    annotation (Line(points={{-20,20},{40,20}}));
  connect(elbow_load_tau.flange, elbow_link.flange_a)
    annotation (Line(points={{130,20},{40,20}}));
  connect(forearm_motor.flange, forearm_drive.flange_a)
    annotation (Line(points={{-80,-10},{-20,-10}}));
  connect(forearm_drive.flange_b, forearm_link.flange_b)
    annotation (Line(points={{-20,-10},{40,-10}}));
  connect(forearm_load_tau.flange, forearm_link.flange_a)
    annotation (Line(points={{130,-10},{40,-10}}));
  connect(wrist_motor.flange, wrist_drive.flange_a)
    annotation (Line(points={{-80,-40},{-20,-40}}));
  connect(wrist_drive.flange_b, wrist_link.flange_b)
    annotation (Line(points={{-20,-40},{40,-40}}));
  connect(wrist_load_tau.flange, wrist_link.flange_a)
    annotation (Line(points={{130,-40},{40,-40}}));
  connect(hand_motor.flange, hand_drive.flange_a)
    annotation (Line(points={{-80,-70},{-20,-70}}));
  connect(hand_drive.flange_b, hand_link.flange_b)
    annotation (Line(points={{-20,-70},{40,-70}}));
  connect(hand_load_tau.flange, hand_link.flange_a)
    annotation (Line(points={{130,-70},{40,-70}}));
  annotation (
    experiment(StopTime=1.5, Interval=0.0001, Tolerance=1e-8),
    Documentation(info="<html>
<p>A serial arm whose six harmonic drives wind up under weight and inertia while the motors follow one motion. The axes are not coupled: tip errors are right within 1 %, but the oscillation of the shipped arm after its motion is too small by factors up to 60 (wrist). The one FMU of the system has the coupled dynamics.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>base_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_motor.height</code></td><td>-122.2 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_drive.d</code></td><td>28 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>base_drive.hysteresis_friction</code></td><td>9.815204504 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>base_drive.hysteresis_stiffness</code></td><td>67000 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>base_link.J</code></td><td>7.40718819165282 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[2]</code></td><td>33.41272944 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[3]</code></td><td>53.77335739 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[4]</code></td><td>63.27751978 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[5]</code></td><td>44.46427224 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[6]</code></td><td>144.73957609 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[7]</code></td><td>-282.36446663 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[8]</code></td><td>748.13069055 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[9]</code></td><td>-1502.38433012 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[10]</code></td><td>1205.32670067 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[11]</code></td><td>-748.18709252 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[12]</code></td><td>347.22481868 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[13]</code></td><td>-121.71798362 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[14]</code></td><td>25.046662 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[15]</code></td><td>-8.75270292 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[16]</code></td><td>-1.98784148 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p[17]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.height</code></td><td>-87.27 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_drive.d</code></td><td>41 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>shoulder_drive.hysteresis_friction</code></td><td>18.99504381 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>shoulder_drive.hysteresis_stiffness</code></td><td>130000 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>shoulder_link.J</code></td><td>8.14835487753431 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[2]</code></td><td>-30.73709333 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[3]</code></td><td>-48.91810652 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[4]</code></td><td>-55.71093232 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[5]</code></td><td>-33.75887074 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[6]</code></td><td>-62.8490004 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[7]</code></td><td>124.49246171 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[8]</code></td><td>-165.6406545 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[9]</code></td><td>556.60006176 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[10]</code></td><td>-109.3565435 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[11]</code></td><td>345.71056877 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[12]</code></td><td>86.47705917 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[13]</code></td><td>172.01464114 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[14]</code></td><td>133.98621159 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[15]</code></td><td>137.98808477 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[16]</code></td><td>129.54565535 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p[17]</code></td><td>117.32029263 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.height</code></td><td>-104.7 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_drive.d</code></td><td>11 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>elbow_drive.hysteresis_friction</code></td><td>4.525004676 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>elbow_drive.hysteresis_stiffness</code></td><td>31000 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>elbow_link.J</code></td><td>2.23554092189438 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[2]</code></td><td>-17.74522872 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[3]</code></td><td>-28.43417588 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[4]</code></td><td>-31.39268635 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[5]</code></td><td>-22.50035874 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[6]</code></td><td>-31.09816833 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[7]</code></td><td>65.15036668 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[8]</code></td><td>-109.67788494 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[9]</code></td><td>321.35289081 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[10]</code></td><td>-158.80461687 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[11]</code></td><td>203.67503592 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[12]</code></td><td>4.41936865 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[13]</code></td><td>88.45182102 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[14]</code></td><td>59.58488762 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[15]</code></td><td>62.46244638 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[16]</code></td><td>55.35465313 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p[17]</code></td><td>45.19978655 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.height</code></td><td>78.54 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_drive.d</code></td><td>1.3 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>forearm_drive.hysteresis_friction</code></td><td>2.32769437 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>forearm_drive.hysteresis_stiffness</code></td><td>16000 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>forearm_link.J</code></td><td>0.0697886093001334 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[2]</code></td><td>-0.24747729 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[3]</code></td><td>-0.32702009 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[4]</code></td><td>-0.63459911 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[5]</code></td><td>-0.45672099 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[6]</code></td><td>2.42544643 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[7]</code></td><td>-13.94523583 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[8]</code></td><td>35.74834952 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[9]</code></td><td>-79.7185252 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[10]</code></td><td>72.57490892 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[11]</code></td><td>-37.13054082 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[12]</code></td><td>29.2136315 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[13]</code></td><td>2.02573635 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[14]</code></td><td>11.26890728 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[15]</code></td><td>8.35609847 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[16]</code></td><td>6.76167576 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p[17]</code></td><td>3.51842498 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.height</code></td><td>-69.81 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_drive.d</code></td><td>1.5 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>wrist_drive.hysteresis_friction</code></td><td>1.453788876 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>wrist_drive.hysteresis_stiffness</code></td><td>10000 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>wrist_link.J</code></td><td>0.15 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[2]</code></td><td>-4.843321 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[3]</code></td><td>-7.87861785 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[4]</code></td><td>-8.29439478 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[5]</code></td><td>-7.38367011 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[6]</code></td><td>-10.36456642 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[7]</code></td><td>26.74287789 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[8]</code></td><td>-66.98867688 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[9]</code></td><td>161.2337765 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[10]</code></td><td>-131.78726118 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[11]</code></td><td>90.60417238 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[12]</code></td><td>-38.36028214 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[13]</code></td><td>17.14888526 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[14]</code></td><td>-1.30610623 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[15]</code></td><td>2.65404273 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[16]</code></td><td>2.11647472 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p[17]</code></td><td>2.38322264 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.height</code></td><td>-157.1 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_drive.d</code></td><td>0.16 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>hand_drive.hysteresis_friction</code></td><td>0.6925001349 N m</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>hand_drive.hysteresis_stiffness</code></td><td>4700 N m/rad</td><td>from hysteresis_loss = 0.00029 rad: 1 arcmin, the limit stated for Harmonic Drive's actuators from ratio 50 on: models/reference/harmonic_drive_catalogue_accuracy.csv</td></tr>
<tr><td><code>hand_link.J</code></td><td>0.0032 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[1]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[2]</code></td><td>-0.00529945 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[3]</code></td><td>-0.0076406 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[4]</code></td><td>-0.01461713 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[5]</code></td><td>0.01207435 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[6]</code></td><td>-0.07863067 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[7]</code></td><td>0.16847643 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[8]</code></td><td>-0.30070171 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[9]</code></td><td>0.56496528 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[10]</code></td><td>-0.260822 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[11]</code></td><td>0.16377099 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[12]</code></td><td>-0.08829367 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[13]</code></td><td>-0.02571448 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[14]</code></td><td>-0.05589163 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[15]</code></td><td>-0.04383153 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[16]</code></td><td>-0.02784474 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p[17]</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
</table>
</html>"));
end SixAxisRobot;
