within JointStiffness;
package Data "Tables of joints, made from their parameter files"
  extends Modelica.Icons.RecordsPackage;
  annotation (Documentation(info="<html>
<p>One record per joint. For your own joint, write its parameter file and run <code>jointfmu modelica --params FILE --out DIR</code>.</p>
</html>"));
end Data;
