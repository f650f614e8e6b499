within JointStiffness.Data;
record << name >> "<< title >>"
  extends << base >>(
<%- for key, value in values.items() %>
    final << key >>=<< value >><< "," if not loop.last else ");" >>
<%- endfor %>
  annotation (Documentation(info="<html>
<p><< about >></p>
<p>Against the curve of jointfmu << version >>: relative error of load and stiffness at most << error >><< more >>.</p>
</html>"));
end << name >>;
