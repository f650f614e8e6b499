within JointStiffness.Examples;
model SixAxisRobot "Robot with six axes"
  extends Modelica.Icons.Example;

  record Base_driveData "CSG-32-100, of base_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=28,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=240000,
      final friction=9.81520450376618,
      final stick=67000,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 67000, 0, 0;
      0.000415522388059702, 27.84, 67000, 0, 0;
      0.000450149253731343, 30.9044776119403, 110000, 0, 0;
      0.00110497693351425, 102.93552238806, 110000, 0, 0;
      0.00119705834464043, 113.524884667571, 120000, 0, 0;
      0.00385935097241067, 433, 120000, 0, 0]);
  end Base_driveData;

  record Shoulder_driveData "CSG-40-100, of shoulder_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=41,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=460000,
      final friction=18.9950438095598,
      final stick=130000,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 130000, 0, 0;
      0.000398769230769231, 51.84, 130000, 0, 0;
      0.000432, 57.3230769230769, 200000, 0, 0;
      0.00108036923076923, 186.996923076923, 200000, 0, 0;
      0.0011704, 206.353538461538, 230000, 0, 0;
      0.00348190635451505, 738, 230000, 0, 0]);
  end Shoulder_driveData;

  record Elbow_driveData "CSG-25-100, of elbow_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=11,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=114000,
      final friction=4.52500467550116,
      final stick=31000,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 31000, 0, 0;
      0.000433548387096774, 13.44, 31000, 0, 0;
      0.000469677419354839, 14.9032258064516, 50000, 0, 0;
      0.00108634838709677, 45.7367741935484, 50000, 0, 0;
      0.00117687741935484, 50.5800774193548, 57000, 0, 0;
      0.00386845500848896, 204, 57000, 0, 0]);
  end Elbow_driveData;

  record Forearm_driveData "CSG-20-100, of forearm_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=1.3,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=58000,
      final friction=2.32769436976909,
      final stick=16000,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 16000, 0, 0;
      0.00042, 6.72, 16000, 0, 0;
      0.000455, 7.4375, 25000, 0, 0;
      0.0011112, 23.8425, 25000, 0, 0;
      0.0012038, 26.3427, 29000, 0, 0;
      0.00398508620689655, 107, 29000, 0, 0]);
  end Forearm_driveData;

  record Wrist_driveData "CSG-17-100, of wrist_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=1.5,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=32000,
      final friction=1.45378887589295,
      final stick=10000,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 10000, 0, 0;
      0.0003744, 3.744, 10000, 0, 0;
      0.0004056, 4.1184, 14000, 0, 0;
      0.000929828571428571, 11.4576, 14000, 0, 0;
      0.00100731428571429, 12.6198857142857, 16000, 0, 0;
      0.00459357142857143, 70, 16000, 0, 0]);
  end Wrist_driveData;

  record Hand_driveData "CSG-14-100, of hand_drive"
    extends JointStiffness.Data.HarmonicDrive(
      final ratio=100,
      final d=0.16,
      final error_1=0,
      final error_1_phase=0,
      final error_2=0,
      final error_2_phase=0,
      final error_4=0,
      final error_4_phase=0,
      final K_FTS0=14200,
      final friction=0.69250013493461,
      final stick=4700,
      final sliders=[
      0.00643263244135639, 2.073388569181e-05;
      0.00693715383056726, 6.90427018603945e-05;
      0.00747865314119822, 0.00012907839057447;
      0.00805937781785326, 0.000203061387425239;
      0.00868162439943443, 0.000293589018470323;
      0.00934771989379946, 0.00040369393230788;
      0.0100599979535163, 0.000536910423741786;
      0.0108207688625576, 0.00069734938381618;
      0.0116322821850867, 0.000889782564839028;
      0.0124966807481445, 0.00111973674758428;
      0.0134159444285374, 0.00139359821866571;
      0.0143918219897486, 0.00171872767919702;
      0.0154257489668884, 0.00210358527166221;
      0.0165187493275826, 0.00255786477816367;
      0.0176713183468021, 0.00309263514123156;
      0.0188832838290521, 0.00372048619820356;
      0.0201536425007433, 0.00445567378430423;
      0.0214803680927408, 0.00531425699477567;
      0.0228601873590036, 0.00631421720350911;
      0.0242883200631697, 0.00747554415598323;
      0.0257581788563869, 0.00882026875287603;
      0.0272610250323827, 0.0103724145841967;
      0.0287855764737015, 0.0121578303030405;
      0.0303175648302414, 0.0142038518230975;
      0.0318392402884997, 0.0165387261604047;
      0.033328824469282, 0.0191907063347724;
      0.0347599154220619, 0.0221866975941479;
      0.0361008539259872, 0.0255502974230967;
      0.037314068174288, 0.0292990229661242;
      0.0383554256067188, 0.0334404567175268;
      0.039173637949058, 0.0379669611242132;
      0.0397097911364354, 0.0428485112067267;
      0.0398971099729722, 0.0480230675570274;
      0.039661124911334, 0.0533837575870811;
      0.0389204965352765, 0.0587619527456548;
      0.0375888918748256, 0.0639051383131143;
      0.035578531709558, 0.0684483180123739;
      0.0328064104232887, 0.0718777123516519;
      0.0292048808791507, 0.0734860707652442;
      0.0247396538303318, 0.0723211158728538;
      0.0194412557666285, 0.0671360291651294;
      0.0134638155145415, 0.0563772811583355;
      0.00721189504917637, 0.0383632214327441;
      0.00174555519008987, 0.0128310221865588],
      final table=[
      0, 0, 4700, 0, 0;
      0.000408510638297872, 1.92, 4700, 0, 0;
      0.000442553191489362, 2.10382978723404, 6100, 0, 0;
      0.00117965817928148, 6.60017021276596, 6100, 0, 0;
      0.00127796302755494, 7.24898221137077, 7100, 0, 0;
      0.00532740215271398, 36, 7100, 0, 0]);
  end Hand_driveData;

  JointStiffness.Components.AngleProfile base_motor(start=0.1, duration=1, height=122.2)
    annotation (Placement(transformation(extent={{-90,70},{-70,90}})));
  JointStiffness.Components.HarmonicDriveSpring base_drive(data=Base_driveData(), friction=9.81520450376618, stick=67000, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,70},{-10,90}})));
  Modelica.Mechanics.Rotational.Components.Inertia base_link(J=7.40718819165282, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,70},{50,90}})));
  JointStiffness.Components.TorqueCurve base_load(start=0.1, duration=1, p={0, 33.412729437048, 53.7733573863264, 63.2775197837778, 44.4642722403492, 144.739576089983, -282.364466627038, 748.130690548881, -1502.38433012318, 1205.3267006701, -748.187092518621, 347.224818682343, -121.717983617423, 25.0466620031973, -8.75270291814799, -1.98784148492605, 0})
    annotation (Placement(transformation(extent={{90,70},{110,90}})));
  Modelica.Mechanics.Rotational.Sources.Torque base_load_tau
    annotation (Placement(transformation(extent={{120,70},{140,90}})));
  JointStiffness.Components.AngleProfile shoulder_motor(start=0.1, duration=1, height=87.27)
    annotation (Placement(transformation(extent={{-90,40},{-70,60}})));
  JointStiffness.Components.HarmonicDriveSpring shoulder_drive(data=Shoulder_driveData(), friction=18.9950438095598, stick=130000, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,40},{-10,60}})));
  Modelica.Mechanics.Rotational.Components.Inertia shoulder_link(J=8.14835487753431, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,40},{50,60}})));
  JointStiffness.Components.TorqueCurve shoulder_load(start=0.1, duration=1, p={0, -30.7370933342866, -48.9181065215086, -55.7109323180711, -33.7588707351706, -62.8490004004721, 124.49246171426, -165.64065449892, 556.600061760271, -109.356543498546, 345.710568771259, 86.4770591683632, 172.014641135789, 133.986211586041, 137.98808477451, 129.54565534736, 117.320292629501})
    annotation (Placement(transformation(extent={{90,40},{110,60}})));
  Modelica.Mechanics.Rotational.Sources.Torque shoulder_load_tau
    annotation (Placement(transformation(extent={{120,40},{140,60}})));
  JointStiffness.Components.AngleProfile elbow_motor(start=0.1, duration=1, height=104.7)
    annotation (Placement(transformation(extent={{-90,10},{-70,30}})));
  JointStiffness.Components.HarmonicDriveSpring elbow_drive(data=Elbow_driveData(), friction=4.52500467550116, stick=31000, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,10},{-10,30}})));
  Modelica.Mechanics.Rotational.Components.Inertia elbow_link(J=2.23554092189438, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,10},{50,30}})));
  JointStiffness.Components.TorqueCurve elbow_load(start=0.1, duration=1, p={0, -17.745228716834, -28.4341758836442, -31.3926863547841, -22.5003587426253, -31.0981683252228, 65.1503666825027, -109.677884936192, 321.352890812328, -158.804616873444, 203.675035923234, 4.41936864666874, 88.4518210201526, 59.5848876185512, 62.4624463833353, 55.3546531307332, 45.1997865488631})
    annotation (Placement(transformation(extent={{90,10},{110,30}})));
  Modelica.Mechanics.Rotational.Sources.Torque elbow_load_tau
    annotation (Placement(transformation(extent={{120,10},{140,30}})));
  JointStiffness.Components.AngleProfile forearm_motor(start=0.1, duration=1, height=-78.54)
    annotation (Placement(transformation(extent={{-90,-20},{-70,0}})));
  JointStiffness.Components.HarmonicDriveSpring forearm_drive(data=Forearm_driveData(), friction=2.32769436976909, stick=16000, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,-20},{-10,0}})));
  Modelica.Mechanics.Rotational.Components.Inertia forearm_link(J=0.0697886093001334, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-20},{50,0}})));
  JointStiffness.Components.TorqueCurve forearm_load(start=0.1, duration=1, p={0, -0.247477294688288, -0.327020087622613, -0.634599111012166, -0.456720985986085, 2.42544642943, -13.9452358274133, 35.7483495192522, -79.71852519671, 72.5749089150186, -37.1305408215289, 29.2136314995631, 2.02573634759984, 11.2689072840075, 8.35609847423945, 6.76167576249273, 3.51842498129903})
    annotation (Placement(transformation(extent={{90,-20},{110,0}})));
  Modelica.Mechanics.Rotational.Sources.Torque forearm_load_tau
    annotation (Placement(transformation(extent={{120,-20},{140,0}})));
  JointStiffness.Components.AngleProfile wrist_motor(start=0.1, duration=1, height=69.81)
    annotation (Placement(transformation(extent={{-90,-50},{-70,-30}})));
  JointStiffness.Components.HarmonicDriveSpring wrist_drive(data=Wrist_driveData(), friction=1.45378887589295, stick=10000, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,-50},{-10,-30}})));
  Modelica.Mechanics.Rotational.Components.Inertia wrist_link(J=0.15, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-50},{50,-30}})));
  JointStiffness.Components.TorqueCurve wrist_load(start=0.1, duration=1, p={0, -4.84332099677688, -7.87861785496388, -8.2943947827276, -7.3836701056989, -10.364566416844, 26.74287788973, -66.9886768782124, 161.233776495955, -131.787261179938, 90.6041723790845, -38.360282137423, 17.1488852644216, -1.30610622827274, 2.65404273055566, 2.11647471999633, 2.38322263678516})
    annotation (Placement(transformation(extent={{90,-50},{110,-30}})));
  Modelica.Mechanics.Rotational.Sources.Torque wrist_load_tau
    annotation (Placement(transformation(extent={{120,-50},{140,-30}})));
  JointStiffness.Components.AngleProfile hand_motor(start=0.1, duration=1, height=157.1)
    annotation (Placement(transformation(extent={{-90,-80},{-70,-60}})));
  JointStiffness.Components.HarmonicDriveSpring hand_drive(data=Hand_driveData(), friction=0.69250013493461, stick=4700, stateSelect=StateSelect.default)
    annotation (Placement(transformation(extent={{-30,-80},{-10,-60}})));
  Modelica.Mechanics.Rotational.Components.Inertia hand_link(J=0.0032, phi(fixed=true, start=0, nominal=1e-3), w(fixed=true, start=0, nominal=0.1))
    annotation (Placement(transformation(extent={{30,-80},{50,-60}})));
  JointStiffness.Components.TorqueCurve hand_load(start=0.1, duration=1, p={0, -0.00529945490594726, -0.00764059839743156, -0.0146171268910089, 0.0120743493896195, -0.0786306652944503, 0.168476427752683, -0.300701710967842, 0.564965280015464, -0.260821997186627, 0.163770989752654, -0.0882936682506417, -0.0257144765984316, -0.055891630412976, -0.0438315346349129, -0.0278447420582337, 1.11022302462516e-16})
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
<p>A serial arm whose six harmonic drives wind up under weight and inertia while the motors follow one motion.</p>
<table>
<tr><th>number</th><th>value</th><th>source</th></tr>
<tr><td><code>base_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_motor.height</code></td><td>122.2 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_drive.d</code></td><td>28 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>base_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>base_link.J</code></td><td>7.40718819165282 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p2</code></td><td>33.412729437048 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p3</code></td><td>53.7733573863264 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p4</code></td><td>63.2775197837778 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p5</code></td><td>44.4642722403492 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p6</code></td><td>144.739576089983 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p7</code></td><td>-282.364466627038 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p8</code></td><td>748.130690548881 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p9</code></td><td>-1502.38433012318 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p10</code></td><td>1205.3267006701 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p11</code></td><td>-748.187092518621 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p12</code></td><td>347.224818682343 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p13</code></td><td>-121.717983617423 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p14</code></td><td>25.0466620031973 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p15</code></td><td>-8.75270291814799 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p16</code></td><td>-1.98784148492605 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>base_load.p17</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_motor.height</code></td><td>87.27 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_drive.d</code></td><td>41 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>shoulder_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>shoulder_link.J</code></td><td>8.14835487753431 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p2</code></td><td>-30.7370933342866 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p3</code></td><td>-48.9181065215086 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p4</code></td><td>-55.7109323180711 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p5</code></td><td>-33.7588707351706 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p6</code></td><td>-62.8490004004721 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p7</code></td><td>124.49246171426 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p8</code></td><td>-165.64065449892 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p9</code></td><td>556.600061760271 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p10</code></td><td>-109.356543498546 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p11</code></td><td>345.710568771259 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p12</code></td><td>86.4770591683632 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p13</code></td><td>172.014641135789 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p14</code></td><td>133.986211586041 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p15</code></td><td>137.98808477451 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p16</code></td><td>129.54565534736 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>shoulder_load.p17</code></td><td>117.320292629501 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_motor.height</code></td><td>104.7 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_drive.d</code></td><td>11 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>elbow_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>elbow_link.J</code></td><td>2.23554092189438 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p2</code></td><td>-17.745228716834 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p3</code></td><td>-28.4341758836442 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p4</code></td><td>-31.3926863547841 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p5</code></td><td>-22.5003587426253 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p6</code></td><td>-31.0981683252228 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p7</code></td><td>65.1503666825027 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p8</code></td><td>-109.677884936192 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p9</code></td><td>321.352890812328 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p10</code></td><td>-158.804616873444 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p11</code></td><td>203.675035923234 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p12</code></td><td>4.41936864666874 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p13</code></td><td>88.4518210201526 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p14</code></td><td>59.5848876185512 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p15</code></td><td>62.4624463833353 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p16</code></td><td>55.3546531307332 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>elbow_load.p17</code></td><td>45.1997865488631 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_motor.height</code></td><td>-78.54 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_drive.d</code></td><td>1.3 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>forearm_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>forearm_link.J</code></td><td>0.0697886093001334 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p2</code></td><td>-0.247477294688288 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p3</code></td><td>-0.327020087622613 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p4</code></td><td>-0.634599111012166 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p5</code></td><td>-0.456720985986085 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p6</code></td><td>2.42544642943 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p7</code></td><td>-13.9452358274133 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p8</code></td><td>35.7483495192522 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p9</code></td><td>-79.71852519671 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p10</code></td><td>72.5749089150186 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p11</code></td><td>-37.1305408215289 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p12</code></td><td>29.2136314995631 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p13</code></td><td>2.02573634759984 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p14</code></td><td>11.2689072840075 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p15</code></td><td>8.35609847423945 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p16</code></td><td>6.76167576249273 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>forearm_load.p17</code></td><td>3.51842498129903 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_motor.height</code></td><td>69.81 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_drive.d</code></td><td>1.5 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>wrist_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>wrist_link.J</code></td><td>0.15 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p2</code></td><td>-4.84332099677688 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p3</code></td><td>-7.87861785496388 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p4</code></td><td>-8.2943947827276 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p5</code></td><td>-7.3836701056989 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p6</code></td><td>-10.364566416844 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p7</code></td><td>26.74287788973 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p8</code></td><td>-66.9886768782124 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p9</code></td><td>161.233776495955 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p10</code></td><td>-131.787261179938 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p11</code></td><td>90.6041723790845 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p12</code></td><td>-38.360282137423 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p13</code></td><td>17.1488852644216 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p14</code></td><td>-1.30610622827274 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p15</code></td><td>2.65404273055566 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p16</code></td><td>2.11647471999633 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>wrist_load.p17</code></td><td>2.38322263678516 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_motor.height</code></td><td>157.1 rad</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_drive.d</code></td><td>0.16 N m s/rad</td><td>2 % of critical with what the axis turns</td></tr>
<tr><td><code>hand_drive.hysteresis_loss</code></td><td>0.00029 rad</td><td>1 arcmin: catalogues of strain-wave gears state 1 to 2 arcmin from ratio 50 on</td></tr>
<tr><td><code>hand_link.J</code></td><td>0.0032 kg m2</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_link.m</code></td><td>0 kg</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_link.l</code></td><td>0 m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.start</code></td><td>0.1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.duration</code></td><td>1 s</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p1</code></td><td>0 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p2</code></td><td>-0.00529945490594726 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p3</code></td><td>-0.00764059839743156 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p4</code></td><td>-0.0146171268910089 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p5</code></td><td>0.0120743493896195 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p6</code></td><td>-0.0786306652944503 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p7</code></td><td>0.168476427752683 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p8</code></td><td>-0.300701710967842 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p9</code></td><td>0.564965280015464 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p10</code></td><td>-0.260821997186627 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p11</code></td><td>0.163770989752654 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p12</code></td><td>-0.0882936682506417 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p13</code></td><td>-0.0257144765984316 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p14</code></td><td>-0.055891630412976 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p15</code></td><td>-0.0438315346349129 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p16</code></td><td>-0.0278447420582337 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
<tr><td><code>hand_load.p17</code></td><td>1.11022302462516e-16 N m</td><td>kinematics and inverse dynamics of [arm]</td></tr>
</table>
</html>"));
end SixAxisRobot;
