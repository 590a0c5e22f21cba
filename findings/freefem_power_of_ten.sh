#!/usr/bin/env bash
# FreeFem++ 4.9 (Debian 4.11): clay with k = 10^-8 is watertight, and nu = 1/3 is zero.
#
# Expected: `real k = 10^-8;` is 1e-8 and `real nu = 1/3;` is 0.333, as both are declared real and are
#     powers and quotients of the language for formulas.
# Seen: both are zero.  Through a blanket of clay of 1 m under 1 m of head no water comes, where 1e-8
#     m3/s per m2 do, and a layer with E = 10 MPa and nu = 1/3 settles 10.0 mm under 100 kPa in place of
#     6.67 mm.  `1/2*x` is zero and `x*1/2` is not.  10.^-8 and 1./3 are right.  No message.
# Meaning: two whole numbers give a whole number, for powers too: any k written as 10^-n, moduli
#     as 10^-n per stiffness, and factors 1/2 and 2/3 in front of an integral drop out, and the solution
#     looks smooth.  Write a point into each number, and print the constants.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(FreeFem++ -nw 2>&1 || true)" != *'version 4.9'* ]]; then
    echo 'needs FreeFem++ 4.9: apt-get install freefem++'
    exit 1
fi
cat > run.edp <<'EDP'
// A square of one metre; labels 1 below and 3 above.
mesh Th = square(8, 8);
fespace Vh(Th, P2);
Vh h, test, ux, uy, vx, vy;

func real discharge(real k) {
    solve Flow(h, test) = int2d(Th)(dx(h)*dx(test) + dy(h)*dy(test)) + on(1, h=0) + on(3, h=1);
    return int1d(Th, 3)(k*dy(h));
}

func real settlement(real nu) {
    real E = 10e6;
    real mu = E/(2*(1 + nu)), lambda = E*nu/((1 + nu)*(1 - 2*nu));
    solve Layer([ux, uy], [vx, vy]) =
        int2d(Th)(lambda*(dx(ux) + dy(uy))*(dx(vx) + dy(vy))
            + 2*mu*(dx(ux)*dx(vx) + dy(uy)*dy(vy)) + mu*(dy(ux) + dx(uy))*(dy(vx) + dx(vy)))
        + int1d(Th, 3)(100e3*vy) + on(1, uy=0) + on(1, 2, 3, 4, ux=0);
    return -1000*uy(0.5, 1);
}

real k = 10^-8;
real nu = 1/3;
cout << "RESULT " << k << " " << nu << " " << discharge(k) << " " << settlement(nu) << " "
    << discharge(10.^-8) << " " << settlement(1./3) << " "
    << int2d(Th)(1/2*x) << " " << int2d(Th)(x*1/2) << endl;
EDP
FreeFem++ -nw -v 0 run.edp > run.log
read -r -a result <<< "$(grep RESULT run.log)"
echo "10^-8 is ${result[1]}, 1/3 is ${result[2]}"
echo "discharge ${result[3]} m3/s, with points ${result[5]}; settlement ${result[4]} mm, with points ${result[6]}"
echo "integral of 1/2*x ${result[7]}, of x*1/2 ${result[8]}"
awk -v q="${result[5]}" -v s="${result[4]}" -v t="${result[6]}" -v left="${result[7]}" -v right="${result[8]}" '
    function far(found, seen) { return found < 0.999 * seen || found > 1.001 * seen }
    BEGIN { exit far(q, 1e-8) || far(s, 10) || far(t, 6.6667) || far(right, 0.25) || left != 0 }'
[[ "${result[1]}" == 0 && "${result[2]}" == 0 && "${result[3]}" == 0 ]]
