#!/usr/bin/env bash
# Makes the lessons' pictures, before and after: docs/learn/make.sh [STUDENT [FOLDER]]   (after ./bootstrap.sh build)
# Without arguments those of the pages, in docs/learn/pictures, in the building of student 1; with a number and a folder those of another one.
set -euo pipefail
student=${1:-1}
here=$(cd "$(dirname "$0")" && pwd)
pictures=${2:-$here/pictures}
mkdir -p "$pictures"
pictures=$(cd "$pictures" && pwd)
command -v rasterslam >/dev/null || PATH="$here/../../build/release/apps:$PATH"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$out"
rs() { rasterslam "$@" >>said.txt 2>&1 || { cat said.txt >&2; exit 1; }; }
plot() { rs plot "$@" --width 85mm --dpi 150 --overwrite; }
for lesson in 1 2 3 4 5 7 8 9 10; do rs learn start "$lesson" --student "$student" -o "l$lesson"; done

# 1: a scan with the lesson's noise, and one without.
plot scan l1/run.rawlog --index 0 -o "$pictures/01-before.png"
rs simulate l1/run.plan.yaml -o exact.rawlog --duration 0.2 --seed 1 --set lidar.fov_deg=180 --set lidar.beams=181
plot scan exact.rawlog --index 0 -o "$pictures/01-after.png"

# 2: the wheels, and a method that closes loops.
rs compare l2/run.rawlog --methods naive_wheel,graph -o c2
plot paths c2 --methods naive_wheel -o "$pictures/02-before.png"
plot paths c2 --methods graph -o "$pictures/02-after.png"

# 3: the original robot's dots, with the lesson's lidar and with its own.
plot operations l3/run.operations.txt -o "$pictures/03-before.png"
awk -F, 'NR > 1 { d = $4 - $3; while (d > 180) d -= 360; while (d < -180) d += 360; printf "turn %.1f\nmove 0.4\n", d }' l3/turns.csv >commands.txt
rs simulate l3/run.plan.yaml -o exact3.rawlog --lidar thesis_360 --commands commands.txt --duration 600 --seed 1
plot operations exact3.operations.txt -o "$pictures/03-after.png"

# 4: the wheels, and the solution of the tests.
rs new method mine
python3 - "$here/../../tests/learn/solutions/lesson04_correct.py" <<'PY'
import re, sys
source = open("mine/mine.py").read()
source = re.sub(r"def correct\(.*?return T_previous_current\n", lambda _: open(sys.argv[1]).read(), source, flags=re.S)
open("mine/mine.py", "w").write(source)
PY
rs compare l4/run.rawlog --methods naive_wheel,mine/mine.ini -o c4
plot map c4/naive_wheel -o "$pictures/04-before.png"
plot map c4/mine -o "$pictures/04-after.png"

# 5: one grid with the squeezed scans, one without.
rs simulate l5/run.plan.yaml -o five.rawlog --seed 1 --duration 60 --set lidar.fov_deg=180 --set lidar.beams=61
rs compare five.rawlog --methods icp,icp_exact -o c5
plot map c5/icp -o "$pictures/05-before.png"
plot map c5/icp_exact -o "$pictures/05-after.png"

# 6: two particles and twenty.
rs simulate l2/run.plan.yaml -o six.rawlog --seed 1 --duration 90 --set odometry.alpha1=0.1 --set odometry.alpha4=0.02
rs run rbpf_exact six.rawlog -o few --set particles.count=2
rs run rbpf_exact six.rawlog -o many
plot map few -o "$pictures/06-before.png"
plot map many -o "$pictures/06-after.png"

# 7: the wheels round a loop, and the loop closed.
rs simulate office_loop -o seven.rawlog --seed "$student" --duration 240 --set odometry.heading_bias_degpm=0.6
rs compare seven.rawlog --methods naive_wheel,graph -o c7
plot map c7/naive_wheel -o "$pictures/07-before.png"
plot map c7/graph -o "$pictures/07-after.png"

# 8: the error of a method that drifts, and of one that does not.
plot errors c7 --methods naive_wheel -o "$pictures/08-before.png"
plot errors c7 --methods graph -o "$pictures/08-after.png"

# 9: two strategies, one flat.
for strategy in longest_ray next_best_view; do
  rs explore l9/plan.yaml --strategy "$strategy" --slam truth --duration 120 --seed "$student" -o "x_$strategy"
done
cp x_longest_ray/path.png "$pictures/09-before.png"
cp x_next_best_view/path.png "$pictures/09-after.png"

# 10: two methods with one seed, and with eight.
for last in 1 8; do
  sed "s/^seeds = .*/seeds = 1..$last/; s/^worlds = .*/worlds = office:seed=11:width_m=20:height_m=14/" l10/claim.ini >"s$last.ini"
  rs bench "s$last.ini" -o "s$last"
done
plot seeds s1 -o "$pictures/10-before.png"
plot seeds s8 -o "$pictures/10-after.png"
ls -l "$pictures"
