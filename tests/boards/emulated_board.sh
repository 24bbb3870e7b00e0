#!/usr/bin/env bash
# Installs the package as on a Debian 13 board of another architecture, and lets its agent learn for five moves.
#
#   tests/boards/emulated_board.sh armhf|arm64 DIR
#
# Python, numpy and OpenCV are Debian's, zenoh and protobuf wheels from PyPI, and pip installs from them alone.
# QEMU emulates the processor, not a board: no kernel, no links, no timing. Server and tracker run on this machine.
# Needs root, debootstrap, qemu-user-static, dpkg-deb, and `make setup`; 1 GB in DIR.
set -euo pipefail
cd "$(dirname "$0")/../.."
case ${1-} in
    armhf) cpu=arm machine=armv7l triple=arm-linux-gnueabihf ;;
    arm64) cpu=aarch64 machine=aarch64 triple=aarch64-linux-gnu ;;
    *) echo "error: say which board: armhf or arm64" >&2; exit 2 ;;
esac
place=$(realpath -m "${2:?where the root may be made}")
root=$place/root libraries=$place/root/usr/lib/$triple
packages=python3,python3-pip,python3-numpy,python3-opencv

# Unpacked and not configured: maintainers' scripts would need the kernel's help to run foreign programs.
if [ ! -e "$root/usr/bin/python3" ]; then
    mkdir -p "$place"
    debootstrap --foreign --variant=minbase --arch="$1" --include=$packages trixie "$root"
    for package in "$root"/var/cache/apt/archives/*.deb; do dpkg-deb -x "$package" "$root"; done
fi
board_python() {
    qemu-$cpu-static -L "$root" -E LD_LIBRARY_PATH="$libraries/blas:$libraries/lapack:$libraries" \
        "$root/usr/bin/python3" "$@"
}
version_of() { sed -n "s/^$1==//p" constraints.txt; }

.venv/bin/pip wheel --quiet --no-deps --wheel-dir "$place/wheels" .
.venv/bin/pip download --quiet --no-deps --only-binary=:all: --dest "$place/wheels" \
    --python-version 313 --implementation cp --abi cp313 --abi abi3 --abi none \
    --platform "manylinux_2_17_$machine" --platform "manylinux_2_28_$machine" --platform any \
    "eclipse-zenoh==$(version_of eclipse-zenoh)" "protobuf==$(version_of protobuf)"
board_python -m pip install --quiet --no-index --find-links "$place/wheels" --root-user-action ignore \
    --break-system-packages --prefix "$place/installed" swarm-runtime

cat > "$place/board.toml" <<'TOML'
[run]
name = "board"
seed = 3
moves = 5

[[robot]]
id = "loner"
south_west_m = [0.5, 0.5]
TOML
endpoint=tcp/127.0.0.1:$(.venv/bin/python -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
run=$(mktemp -d "$place/run-XXXX")/run
.venv/bin/swarm-server "$place/board.toml" --listen "$endpoint" --out "$run" & server=$!
.venv/bin/tracker-bridge "$place/board.toml" --connect "$endpoint" & tracker=$!
trap 'kill $server $tracker 2>/dev/null || true' EXIT
(
    cd "$place"
    PYTHONPATH=$(echo installed/local/lib/python3*/dist-packages)
    export PYTHONPATH=$place/$PYTHONPATH
    board_python -c 'import cv2, numpy, platform; print(platform.machine(), "numpy", numpy.__version__, "OpenCV", cv2.__version__)'
    board_python -m robot_agent board.toml --robot loner --connect "$endpoint"
)
wait $server
.venv/bin/swarm check "$run"
