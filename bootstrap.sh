#!/usr/bin/env bash
# From a fresh Debian or Ubuntu machine to a working checkout. See `./bootstrap.sh help`.
set -u
cd "$(dirname "$0")" || exit 1
root=$PWD
log=$root/.bootstrap.log
venv=$root/.venv
uv_version=0.13.8
export PATH="$PATH:/usr/sbin:/sbin" # ldconfig
unset PYTHONPATH PYTHONHOME         # another Python's packages stay out

usage() {
    cat <<'END'
usage: ./bootstrap.sh COMMAND

  run      set up, then compute a disc that settles onto a wall: its gap against the exact one,
           a ParaView series and a picture in a new folder under runs/
  test     set up, then lint, types and tests (more words go to pytest: ./bootstrap.sh test -m slow)
  install  set up only: system libraries, a Python >= 3.12, the packages of requirements.lock in .venv

What is there already is not installed again. Exit codes: 1 a step failed, 2 something you must supply.
END
}

say() { printf '==> %s\n' "$*" >&2; }
refuse() { printf 'error: %s\n' "$*" >&2; exit 2; }

# step WHAT COMMAND...: run quietly; if it fails, show what its log says about it and stop.
step() {
    local what=$1; shift
    say "$what"
    "$@" >"$log" 2>&1 </dev/null && return
    printf 'error: "%s" failed; the end of %s:\n' "$what" "$log" >&2
    { grep -iE '^ *(error|e|fatal):' "$log" || tail -n 8 "$log"; } | tail -n 8 | sed 's/^/    /' >&2
    exit 1
}

# ---- system libraries ------------------------------------------------------------------------------------

# One line for each thing that is missing: what it is, then its packages. gmsh's wheel wants GL and X,
# pyvista's off-screen pictures EGL, and FFCx compiles the forms at run time.
missing_from_system() {
    local known soname package
    known=$(ldconfig -p 2>/dev/null)
    while read -r soname package; do
        [[ $known == *"$soname (libc6,x86-64"* ]] || echo "$soname $package"
    done <<'END'
libGL.so.1 libgl1
libEGL.so.1 libegl1
libGLU.so.1 libglu1-mesa
libXcursor.so.1 libxcursor1
libXft.so.2 libxft2
libXinerama.so.1 libxinerama1
libgomp.so.1 libgomp1
END
    command -v gcc >/dev/null || echo "gcc gcc"
    [ -e /usr/include/stdio.h ] || echo "stdio.h libc6-dev"
    [ -n "${SSL_CERT_FILE:-}" ] || [ -e /etc/ssl/certs/ca-certificates.crt ] || [ -d /etc/pki ] ||
        echo "certificates ca-certificates"
}

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi; }
may_install() { command -v apt-get >/dev/null && { [ "$(id -u)" = 0 ] || sudo -n true 2>/dev/null; }; }
apt_install() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"
}
# A fresh machine has no package lists, an old one stale lists: update only if it fails without.
apt_install_updated() { apt_install "$@" || { as_root apt-get update -qq && apt_install "$@"; }; }

# need WHAT PACKAGES...: install them where we may, else say what to install.
need() {
    local what=$1; shift
    may_install ||
        refuse "missing: $what; as root run (or your system's like):" \
            "apt-get install -y --no-install-recommends $*"
    step "installing with apt: $*" apt_install_updated "$@"
}

# Everything that apt can give, asked for at once.
system() {
    local missing
    missing=$(missing_from_system; ready || missing_python)
    [ -z "$missing" ] && return
    # shellcheck disable=SC2046  # words on purpose
    need "$(cut -d' ' -f1 <<<"$missing" | paste -sd' ')" $(cut -d' ' -f2- <<<"$missing")
}

# ---- Python ----------------------------------------------------------------------------------------------

# Whether $1 is a Python that will do: a version with wheels in the lock, venv with pip, headers for FFCx.
suits() {
    "$1" -c '
import os, sys, sysconfig, ensurepip, venv
headers = os.path.join(sysconfig.get_path("include"), "Python.h")
sys.exit(not ((3, 12) <= sys.version_info < (3, 15) and os.path.exists(headers)))' 2>/dev/null
}

# Prints the first Python that suits: on the PATH, pyenv's, conda's, the one fetched here.
find_python() {
    local candidate
    for candidate in python3.13 python3.12 python3.14 python3 \
        "${PYENV_ROOT:-${HOME:-}/.pyenv}"/versions/3.1[2-4]*/bin/python3 \
        "${CONDA_PREFIX:-/nonexistent}"/bin/python3 \
        "${HOME:-}"/{miniforge3,miniconda3,anaconda3}/bin/python3 \
        "$root"/.python/*/bin/python3; do
        candidate=$(command -v "$candidate") || continue
        [[ $candidate == "$venv"/* ]] && continue # .venv cannot be made anew from itself
        suits "$candidate" && echo "$candidate" && return
    done
    return 1
}

# The line for missing_from_system's list when apt could give a Python that suits and none is there.
missing_python() {
    local version
    find_python >/dev/null && return
    command -v apt-cache >/dev/null || return
    # A fresh machine without package lists knows no candidate yet.
    may_install && [ -z "$(apt-cache policy python3)" ] &&
        step "reading the package lists" as_root apt-get update -qq
    version=$(apt-cache policy python3 2>/dev/null | awk '$1 == "Candidate:" { print $2 }')
    [[ $version =~ ^3\.1[2-4]([.~+-]|$) ]] && echo "Python>=3.12 python3 python3-venv python3-dev"
}

# Fetches a Python with uv, itself fetched with pip if need be. This path has never been tried to its
# end by us: the machines we have cannot reach the place that uv downloads from.
fetch_python() {
    local uv
    uv=$(command -v uv) || uv=$root/.uv/bin/uv
    [ -x "$uv" ] ||
        { python3 -m venv --clear .uv && .uv/bin/python -m pip install "uv==$uv_version"; } || return
    UV_PYTHON_INSTALL_DIR=$root/.python "$uv" python install --no-bin 3.12
}

python_or_stop() {
    find_python && return
    say "no Python >= 3.12 here nor from apt: trying to fetch one with uv"
    if ! command -v uv >/dev/null && ! python3 -c 'import ensurepip' 2>/dev/null && may_install; then
        need "python3-venv" python3-venv # any version: it only has to install uv
    fi
    fetch_python >"$log" 2>&1 </dev/null
    find_python ||
        refuse "no Python 3.12, 3.13 or 3.14 with venv and headers (Python.h) found, and uv could not fetch one" \
            "(see $log); install one (distribution's packages, pyenv or conda) and call again"
}

# ---- packages --------------------------------------------------------------------------------------------

# What the environment was made from; differs when it must be made again.
stamp() {
    cat requirements.lock pyproject.toml | sha256sum
    echo "$root"
    "$venv/bin/python" -VV && suits "$venv/bin/python" && echo complete
}
ready() { [ -f "$venv/stamp" ] && [ "$(stamp 2>/dev/null)" = "$(cat "$venv/stamp")" ]; }

packages() {
    local python pip=("$venv/bin/python" -m pip --disable-pip-version-check install)
    ready && return
    python=$(python_or_stop) || exit
    step "making .venv with $("$python" -V)" "$python" -m venv --clear "$venv"
    step "installing requirements.lock (1.4 GB on disk)" \
        "${pip[@]}" --require-hashes --only-binary :all: -r requirements.lock
    step "installing the project" "${pip[@]}" --no-deps --no-build-isolation --no-index -e .
    # Where Python may not keep what it makes of the sources (PYTHONDONTWRITEBYTECODE) each start would make it.
    step "compiling the sources" "$venv/bin/python" -m compileall -q fsi meshes cases postprocess
    # Numba keeps what it compiled beside the sources: the first user of pores need not wait for it.
    step "compiling the loops of pores" "$venv/bin/fsi" solve cases/pores/couette_N10.toml
    step "compiling those of narrow necks" "$venv/bin/fsi" solve cases/pores/nearly_touching.toml
    stamp >"$venv/stamp.new" && mv "$venv/stamp.new" "$venv/stamp" # last: an interrupted set-up has none
}

install() {
    [ "$(uname -sm)" = "Linux x86_64" ] ||
        refuse "the solver's wheels are for Linux on x86_64, this is $(uname -sm); use conda: environment.yml"
    system
    packages
    export PATH="$venv/bin:$PATH" # its mpiexec is the one that fits
}

# ---- commands --------------------------------------------------------------------------------------------

# The first of runs/NAME, runs/NAME-2, ... that does not exist.
new_folder() {
    local folder=runs/$1 n=2
    while [ -e "$folder" ]; do folder=runs/$1-$((n++)); done
    echo "$folder"
}

run() {
    local folder
    folder=$(new_folder settling_disc)
    say "a disc settles onto a wall under its weight: results in $folder"
    fsi run cases/settling_disc.toml --output "$folder" &&
        fsi analyse settling "$folder" &&
        fsi render "$folder" &&
        say "done: open $folder/fluid.pvd in ParaView"
}

test_all() {
    local failed=()
    ruff check . || failed+=("ruff check")
    ruff format --check . || failed+=("ruff format")
    mypy --strict || failed+=("mypy")
    [ ${#failed[@]} = 0 ] || say "failed before the tests: $(printf '%s, ' "${failed[@]}" | sed 's/, $//')"
    python -m pytest -n auto --dist worksteal "$@" && [ ${#failed[@]} = 0 ]
}

command=${1:-help}
[ $# = 0 ] || shift
case $command in
    run) install && run ;;
    test) install && test_all "$@" ;;
    install) install && say "ready: .venv/bin/fsi --help" ;;
    help | -h | --help) usage ;;
    *) refuse "no such command: $command; it is run, test or install" ;;
esac
