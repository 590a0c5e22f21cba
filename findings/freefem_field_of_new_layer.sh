#!/usr/bin/env bash
# FreeFem++ 4.9 (Debian 4.11): a new fill is born with the pore pressure of the ground below it.
#
# Expected: a field of one mesh that is assigned to a space on a larger mesh is zero, undefined or an
#     error outside the first mesh.
# Seen: a pressure of 10 + 10 times the depth on ground from y = -1 to 0 is assigned to a mesh that
#     reaches to y = 1.  The points of the new layer have the value of the nearest old point: 10 at y =
#     0.5 and 1, and 20 at y = -1.5 below the old base, where the line would go on to 25.  The
#     integral over the new layer is 10 in place of 0.  No message.
# Meaning: this is the way from one stage to the next.  The new soil starts with stresses, pressures or
#     displacements of the surface it is placed on, and a clipped window of the first model goes on
#     beyond its edges.  Multiply by a function that is zero outside of the first mesh.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(FreeFem++ -nw 2>&1 || true)" != *'version 4.9'* ]]; then
    echo 'needs FreeFem++ 4.9: apt-get install freefem++'
    exit 1
fi
cat > run.edp <<'EDP'
mesh ground = square(4, 4, [x, y - 1]);
mesh both = square(4, 10, [x, 2.5*y - 1.5]);
fespace Old(ground, P1);
fespace New(both, P1);
Old pressure = 10 - 10*y;
New next = pressure;
cout << "RESULT " << next(0.5, -0.5) << " " << next(0.5, 0.5) << " " << next(0.5, 1) << " "
    << next(0.5, -1.5) << " " << int2d(both)(pressure*(y > 0)) << endl;
EDP
FreeFem++ -nw -v 0 run.edp > run.log
read -r _ inside middle top below integral <<< "$(grep RESULT run.log)"
echo "in the ground $inside, in the new layer $middle and $top, below $below, integral $integral"
awk -v a="$inside" -v b="$middle" -v c="$top" -v d="$below" -v e="$integral" '
    function far(found, seen) { return found < 0.999 * seen || found > 1.001 * seen }
    BEGIN { exit far(a, 15) || far(b, 10) || far(c, 10) || far(d, 20) || far(e, 10) }'
