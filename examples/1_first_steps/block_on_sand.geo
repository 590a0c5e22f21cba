// A block of concrete on sand, in metres: gmsh -2 -format msh22 block_on_sand.geo
SetFactory("OpenCASCADE");
Rectangle(1) = {-4, -4, 0, 8, 4};
Rectangle(2) = {-1, 0, 0, 2, 1};
Coherence;                                  // the two share the line between them
Physical Surface("sand") = {1};
Physical Surface("concrete") = {2};
eps = 1e-6;
Physical Curve("bottom") = Curve In BoundingBox {-4-eps, -4-eps, -eps, 4+eps, -4+eps, eps};
Physical Curve("top") = Curve In BoundingBox {-1-eps, 1-eps, -eps, 1+eps, 1+eps, eps};
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Field[1] = Box;
Field[1].VIn = 0.14;
Field[1].VOut = 0.5;
Field[1].XMin = -1.3; Field[1].XMax = 1.3; Field[1].YMin = -0.7; Field[1].YMax = 1;
Field[1].Thickness = 2.5;
Background Field = 1;
Mesh.ElementOrder = 2;
