# Shared by the scripts: installs what Selkie needs, configures and builds it.
# Source it after `set -euo pipefail`.

selkie_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
selkie_type=Release
selkie_unity=ON
selkie_werror=OFF
selkie_sanitize=OFF

# What Open MPI, OpenBLAS and OpenMP must know: one thread per rank, and that
# root may run it (containers).
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

say() { printf -- '-- %s\n' "$*"; }
fail() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# The options that all scripts know: true if $1 was one of them.
build_option() {
  case $1 in
    --debug) selkie_type=Debug ;;
    --no-unity) selkie_unity=OFF ;;
    --werror) selkie_werror=ON ;;
    --sanitize)
      selkie_sanitize=ON
      # Open MPI keeps what it has to the end, and PMIx what it should not.
      export ASAN_OPTIONS=detect_leaks=0
      ;;
    *) return 1 ;;
  esac
}

installed() {
  [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# Installs those of the named Debian packages that are missing: as root; else
# prints the line that does it, and stops.
need_packages() {
  local missing=() package
  for package in "$@"; do
    installed "$package" || missing+=("$package")
  done
  [[ ${#missing[@]} -gt 0 ]] || return 0
  if [[ $(id -u) -ne 0 ]]; then
    {
      echo "Selkie needs packages that are not installed. Please run this line, then try again:"
      echo "sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}"
    } >&2
    exit 1
  fi
  say "Installing with apt-get: ${missing[*]}"
  local log
  log=$(mktemp)
  if ! { apt-get update &&
    DEBIAN_FRONTEND=noninteractive \
      apt-get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1 </dev/null; then
    tail -n 30 "$log" >&2
    fail "apt-get could not install these packages (all its output: $log)"
  fi
  rm -f "$log"
}

# A compiler, cmake, ninja, deal.II and what else the build uses. Whoever has
# set DEAL_II_DIR brings an own deal.II with its own MPI.
install_dependencies() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "No apt-get here, so nothing is installed. Needed: g++, cmake, ninja, GoogleTest, muParser, python3 with matplotlib, and deal.II >= 9.4 with MPI, p4est and Trilinos"
    return 0
  fi
  local packages=(libgtest-dev libmuparser-dev python3-matplotlib)
  command -v cmake >/dev/null || packages+=(cmake)
  command -v ninja >/dev/null || packages+=(ninja-build)
  command -v c++ >/dev/null || packages+=(g++)
  if [[ -z ${DEAL_II_DIR:-} ]]; then
    # OpenBLAS: MUMPS is four times faster than with the reference BLAS that
    # deal.II's package pulls in.
    packages+=(libdeal.ii-dev openmpi-bin libopenblas0-pthread)
  fi
  need_packages "${packages[@]}"
  if [[ -z ${DEAL_II_DIR:-} ]]; then
    local version
    version=$(dpkg-query -W -f '${Version}' libdeal.ii-dev)
    dpkg --compare-versions "$version" ge 9.4 ||
      fail "Selkie needs deal.II 9.4 or newer; the package libdeal.ii-dev here is $version. Debian 12 has 9.4.1; for an own build set DEAL_II_DIR"
  fi
}

# OMP_NUM_THREADS would be nproc's answer.
cores() { env -u OMP_NUM_THREADS nproc 2>/dev/null || echo 1; }

# One compiler per core, but not more than memory holds (1.5 GB each).
compilers() {
  local n kilobytes
  n=$(cores)
  kilobytes=$(awk '/^MemAvailable/ { print $2 }' /proc/meminfo 2>/dev/null || true)
  if [[ -n $kilobytes && $n -gt $((kilobytes / 1500000)) ]]; then
    n=$((kilobytes / 1500000))
  fi
  echo $((n > 1 ? n : 1))
}

# Configures and builds. $build is the directory afterwards; each kind of build
# has its own. Arguments: targets (none: all).
configure_and_build() {
  build=$selkie_root/build
  [[ $selkie_type == Release ]] || build+=-debug
  [[ $selkie_unity == ON ]] || build+=-no-unity
  [[ $selkie_sanitize == OFF ]] || build+=-sanitize

  local generator=()
  [[ -e $build/CMakeCache.txt ]] || generator=(-G Ninja)
  local begin=$SECONDS
  mkdir -p "$build"
  if ! cmake "${generator[@]}" -S "$selkie_root" -B "$build" \
    -DCMAKE_BUILD_TYPE=$selkie_type -DSELKIE_UNITY=$selkie_unity \
    -DSELKIE_WERROR=$selkie_werror -DSELKIE_SANITIZE=$selkie_sanitize \
    >"$build/configure.log" 2>&1; then
    tail -n 40 "$build/configure.log" >&2
    fail "cmake could not configure Selkie (all its output: $build/configure.log)"
  fi

  local quiet=() targets=()
  [[ -t 1 ]] || quiet=(-- --quiet)
  [[ $# -eq 0 ]] || targets=(--target "$@")
  if [[ ! -e $build/built ]]; then
    say "Building in $build with $(compilers) jobs at a time: some minutes the first time"
  fi
  cmake --build "$build" -j "$(compilers)" "${targets[@]}" "${quiet[@]}" ||
    fail "the build failed; its messages are above"
  if [[ ! -e $build/built ]]; then
    say "Built in $((SECONDS - begin)) s"
    touch "$build/built"
  fi
}
