// Ground with a wall and two lifts of a pit, in metres: gmsh -2 -format msh22 anchored_pit.geo
SetFactory("OpenCASCADE");
Rectangle(1) = {0, -14, 0, 20, 14};
Rectangle(2) = {-8, -14, 0, 8, 9};
Rectangle(3) = {-8, -5, 0, 8, 3};
Rectangle(4) = {-8, -2, 0, 8, 2};
Point(101) = {0, 0, 0};
Point(102) = {0, -1.5, 0};                   // the head of the anchor
Point(103) = {0, -9, 0};                     // the toe of the wall
Line(101) = {101, 102};
Line(102) = {102, 103};
BooleanFragments{ Surface{1:4}; Delete; }{ Curve{101, 102}; Delete; }   // all of them share their lines
eps = 1e-6;
Physical Surface("ground") = {1, 2};
Physical Surface("lift 2") = {3};
Physical Surface("lift 1") = {4};
Physical Curve("wall") = Curve In BoundingBox {-eps, -9-eps, -eps, eps, eps, eps};
Physical Curve("street") = Curve In BoundingBox {-eps, -eps, -eps, 20+eps, eps, eps};
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Field[1] = Box;
Field[1].VIn = 0.8;
Field[1].VOut = 2.4;
Field[1].XMin = -2; Field[1].XMax = 3; Field[1].YMin = -10; Field[1].YMax = 0;
Field[1].Thickness = 10;
Background Field = 1;
Mesh.ElementOrder = 2;
