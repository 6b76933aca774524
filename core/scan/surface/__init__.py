"""Points, their fusion, normals, triangles: the measured surface."""
