# Sourced by app/run and tests/run, after `root` is set: installs what the build needs and builds.
# All messages go to standard error and nothing is read from standard input: both are the program's.
# shellcheck shell=bash disable=SC2034,SC2154

# What configuring and building one preset takes. libimgui-dev's pkg-config file wants libstb-dev.
build_packages=(
    cmake ninja-build g++ pkg-config
    nlohmann-json3-dev libcli11-dev libpng-dev zlib1g-dev libhwy-dev
    libglfw3-dev libglm-dev libimgui-dev libstb-dev
    libgtest-dev libmpfr-dev
)
# OpenGL in memory, for --headless: either of the two will do, and Mesa 25.1 has no OSMesa any more.
memory_packages=(libosmesa6 libegl1 libgl1-mesa-dri)
# What the tests of the viewer run on besides: a display in memory and its pointer.
test_packages=("${memory_packages[@]}" xvfb xdotool python3)
# What ./tests/format calls.
format_packages=(clang-format)
installed_now=no
log=
trap 'rm -f -- "$log"' EXIT

say() { printf 'ivory: %s\n' "$*" >&2; }

# Runs a command in silence; shows what it said and ends where it fails.
quietly() {
    log=$(mktemp)
    if ! "$@" >"$log" 2>&1 </dev/null; then
        cat "$log" >&2
        rm -f "$log"
        say "failed: $*"
        exit 1
    fi
    rm -f "$log"
}

# find_missing NAME...: sets `missing` to those that are not installed.
find_missing() {
    local present name
    present=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
    missing=()
    for name in "$@"; do
        grep -qxF "installed $name" <<<"$present" || missing+=("$name")
    done
}

has_apt() { command -v apt-get >/dev/null && command -v dpkg-query >/dev/null; }
can_install() { ((EUID == 0)) || command -v sudo >/dev/null; }

apt_get() {
    local as_root=()
    if ((EUID != 0)); then as_root=(sudo); fi
    quietly "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq -o DPkg::Lock::Timeout=300 "$@"
}

# install_packages NAME...: with the lists of packages as they are.
install_packages() {
    say "installing $*"
    apt_get install --yes --no-install-recommends "$@"
    installed_now=yes
}

# need_packages NAME...: installs those that are missing. Where it cannot, it says what is needed and
# goes on: the tools may be there without their packages.
need_packages() {
    if ! has_apt; then
        if [[ ! -d $root/build ]]; then
            say "no apt-get here; needed are what Debian calls: $*"
        fi
        return 0
    fi
    local missing
    find_missing "$@"
    if ((${#missing[@]} == 0)); then return 0; fi
    if ! can_install; then
        say "missing packages, and neither root nor sudo to install them: ${missing[*]}"
        return 0
    fi
    apt_get update
    install_packages "${missing[@]}"
}

# Of NAME..., what apt-get could install.
known_packages() {
    LC_ALL=C apt-cache policy "$@" | awk '
        /^[^ ]/ { name = $1; sub(/:$/, "", name) }
        $1 == "Candidate:" && $2 != "(none)" { print name }'
}

# want_packages NAME...: installs those that are missing and that this system has, and says which it
# goes without.
want_packages() {
    local missing known
    if ! has_apt; then return 0; fi
    find_missing "$@"
    if ((${#missing[@]} == 0)); then return 0; fi
    if can_install; then
        mapfile -t known < <(known_packages "${missing[@]}")
        # Not at every call where some are unknown; but a new system has no lists at all yet.
        if ((${#known[@]} > 0)) || [[ -z $(known_packages cmake) ]]; then
            apt_get update
            mapfile -t known < <(known_packages "${missing[@]}")
        fi
        if ((${#known[@]} > 0)); then install_packages "${known[@]}"; fi
        find_missing "${missing[@]}"
    fi
    if ((${#missing[@]} > 0)); then say "goes without ${missing[*]}: what needs them is left out"; fi
}

# CMake 3.25 or newer on the path; where the distribution's is older (Ubuntu 22.04) PyPI's, below build/.
need_cmake() {
    local own=$root/build/cmake
    if [[ ! -x $own/bin/cmake ]]; then
        local version
        version=$(cmake --version 2>/dev/null | sed -n 's/^cmake version //p')
        if [[ $(printf '%s\n' 3.25 "$version" | sort -V | head -n 1) == 3.25 ]]; then return 0; fi
        need_packages python3-venv
        say "installing CMake from PyPI into build/cmake (found ${version:-none}, needed 3.25)"
        quietly python3 -m venv "$own"
        quietly "$own/bin/pip" install --quiet 'cmake>=3.25,<4'
    fi
    PATH=$own/bin:$PATH
}

# build PRESET [TARGET...]: configures where that has not been done and builds, all targets without one.
build() {
    local preset=$1 folder=$root/build/$1
    shift
    mkdir -p "$folder"
    # One build at a time in a folder; the lock ends with this function.
    local lock
    exec {lock}>"$folder/.lock"
    if command -v flock >/dev/null; then flock "$lock"; fi
    build_locked "$preset" "$folder" "$@"
    exec {lock}>&-
}

build_locked() {
    local preset=$1 folder=$2
    shift 2
    if [[ $installed_now == yes || ! -e $folder/build.ninja ||
        $root/CMakePresets.json -nt $folder/build.ninja ]]; then
        say "configuring build/$preset"
        quietly env -C "$root" cmake --preset "$preset"
    fi
    local plan
    plan=$(ninja -C "$folder" -n "$@" 2>/dev/null </dev/null | tail -n 1)
    if [[ $plan == "ninja: no work to do." ]]; then return 0; fi
    say "building build/$preset"
    if [[ -t 2 ]]; then
        ninja -C "$folder" "$@" >&2 </dev/null
    else
        quietly ninja -C "$folder" "$@"
    fi
}
