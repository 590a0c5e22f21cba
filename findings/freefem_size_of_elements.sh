#!/usr/bin/env bash
# FreeFem++ 4.9 (Debian 4.11): elements of 1 mm were asked for, and have 25 mm.
#
# Expected: `adaptmesh(Th, size, IsMetric=1)` makes elements of this size, or says why not.
# Seen: a unit square with 4 x 4 cells.  For sizes of 0.1 and 0.05 the number of triangles is about
#     2.3 / size**2, which is right.  For 0.01 and 0.001 there are 2,700 triangles (25 mm) in place of
#     23,000 and 2.3 million.  Called twice for 0.01 it makes 23,000.  An element is divided by ten at
#     most in one call (`maxsubdiv`).  No message; too few points (`nbvx`) have one.
# Meaning: a study of convergence stops to change, which looks like convergence; shear bands and filters
#     of piping of a given width are ten elements too coarse.  Compute the sizes of the mesh that
#     came back, and repeat the call until they stay.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(FreeFem++ -nw 2>&1 || true)" != *'version 4.9'* ]]; then
    echo 'needs FreeFem++ 4.9: apt-get install freefem++'
    exit 1
fi
cat > run.edp <<'EDP'
mesh coarse = square(4, 4);
cout << "RESULT";
real[int] sizes = [0.1, 0.05, 0.01, 0.001];
for (int i = 0; i < 4; i++) {
    mesh fine = adaptmesh(coarse, sizes[i], IsMetric=1);
    cout << " " << fine.nt;
}
mesh once = adaptmesh(coarse, 0.01, IsMetric=1, nbvx=100000);
mesh twice = adaptmesh(once, 0.01, IsMetric=1, nbvx=100000);
cout << " " << once.nt << " " << twice.nt << endl;
EDP
FreeFem++ -nw -v 0 run.edp > run.log
read -r _ tenth half small tiny once twice <<< "$(grep RESULT run.log)"
echo "sizes 0.1, 0.05, 0.01 and 0.001: $tenth, $half, $small and $tiny triangles"
echo "0.01 with room for more points: $once, called twice $twice"
awk -v a="$tenth" -v b="$half" -v c="$small" -v d="$tiny" -v e="$once" -v f="$twice" '
    function far(found, seen) { return found < 0.9 * seen || found > 1.1 * seen }
    BEGIN { exit far(a, 231) || far(b, 924) || far(c, 2700) || far(d, 2700) || far(e, 2700) \
        || far(f, 23094) }'
