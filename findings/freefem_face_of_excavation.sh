#!/usr/bin/env bash
# FreeFem++ 4.9 (Debian 4.11): the face of an excavation is held by the support of the right side.
#
# Expected: the new sides that `trunc` leaves where a part is cut out of a mesh have a label of their own,
#     or none, and are free.
# Seen: they have the label 2, which is the right side of a `square`.  In a block of 1 m by 1 m with its
#     upper right quarter excavated, label 2 is 1.5 m long in place of 0.5 m.  With smooth supports at
#     the sides (label 2 and 4) the face moves by 0 under its weight, and its top settles by 0.57 of the
#     right value.  With label=9 in `trunc` it moves.  No message.
# Meaning: an unsupported face has the displacement of a strutted one, on the unsafe side, and loads or
#     flows of label 2 enter through it.  Give `trunc` a label, and compare the length of each label with
#     the drawing.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(FreeFem++ -nw 2>&1 || true)" != *'version 4.9'* ]]; then
    echo 'needs FreeFem++ 4.9: apt-get install freefem++'
    exit 1
fi
cat > run.edp <<'EDP'
mesh block = square(16, 16);
mesh default = trunc(block, !(x > 0.5 && y > 0.5));

// E = 10 MPa, nu = 0.3, 20 kN/m3; base fixed, sides smooth.
func real[int] moved(int face) {
    mesh Th = trunc(block, !(x > 0.5 && y > 0.5), label=face);
    fespace Vh(Th, P2);
    Vh ux, uy, vx, vy;
    real mu = 10e6/2.6, lambda = 10e6*0.3/(1.3*0.4);
    solve Weight([ux, uy], [vx, vy]) =
        int2d(Th)(lambda*(dx(ux) + dy(uy))*(dx(vx) + dy(vy))
            + 2*mu*(dx(ux)*dx(vx) + dy(uy)*dy(vy)) + mu*(dy(ux) + dx(uy))*(dy(vx) + dx(vy)))
        + int2d(Th)(20e3*vy) + on(1, ux=0, uy=0) + on(2, 4, ux=0);
    real[int] result = [1000*ux(0.5, 0.75), -1000*uy(0.5, 1)];
    return result;
}
real[int] held = moved(2), free = moved(9);
cout << "RESULT " << int1d(default, 2)(1.) << " " << held[0] << " " << held[1] << " " << free[0] << " "
    << free[1] << endl;
EDP
FreeFem++ -nw -v 0 run.edp > run.log
read -r _ side held top free other <<< "$(grep RESULT run.log)"
echo "label 2 is $side m long; the face moves by $held mm, with a label of its own by $free mm"
echo "settlement of the top $top and $other mm"
awk -v a="$side" -v b="$held" -v c="$free" -v d="$top" -v e="$other" '
    function far(found, seen) { return found < 0.99 * seen || found > 1.01 * seen }
    BEGIN { exit far(a, 1.5) || b > 1e-9 || b < -1e-9 || far(c, 0.0693) || far(d, 0.693) || far(e, 0.693) }'
