# What launch/ballast, tests/run and .ci/run share: install missing packages, configure, build. Source it; then call set_up.
# A second call at the same time waits; a call with nothing to do takes well under a third of a second.

export LC_ALL=C DEBIAN_FRONTEND=noninteractive
ballast_root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
ballast_build=${BALLAST_BUILD:-$ballast_root/build}

say() { printf 'ballast: %s\n' "$*" >&2; }
die() { say "$@"; exit 5; }

# packages_of SECTION...: the packages of these sections of packages.txt.
packages_of() {
  local wanted=" $* " section='' line
  while read -r line; do
    case $line in
      '' | '#'*) ;;
      '['*']') section=${line#[}; section=${section%]} ;;
      *) [[ $wanted == *" $section "* ]] && printf '%s\n' "$line" ;;
    esac
  done <"$ballast_root/launch/packages.txt"
  return 0
}

# missing_of SECTION...: those of them that are not installed.
missing_of() {
  local package
  for package in $(packages_of "$@"); do
    [[ $(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null) == ?i* ]] || printf '%s\n' "$package"
  done
}

# as_root COMMAND...: with sudo where needed.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo -- "$@"; fi
}

# apt_install LOG PACKAGE...: quietly; the log has everything.
apt_install() {
  local log=$1
  shift
  as_root env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -q -y -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 \
    install --no-install-recommends "$@" >>"$log" 2>&1
}

# install_packages SECTION...: what is missing, after saying what.
install_packages() {
  local stamp="$ballast_build/.packages.${*// /-}" log="$ballast_build/install.log" required=() extra=() package section
  stamp=${stamp// /-}
  cmp -s "$ballast_root/launch/packages.txt" "$stamp" && return
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "this system has no apt-get; what corresponds to these Debian packages must be there:"
    say "$(packages_of "$@" | tr '\n' ' ')"
    return
  fi
  for section in "$@"; do
    for package in $(missing_of "$section"); do
      if [ "$section" = optional ]; then extra+=("$package"); else required+=("$package"); fi
    done
  done
  if [ $((${#required[@]} + ${#extra[@]})) -gt 0 ]; then
    if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
      [ ${#required[@]} = 0 ] && { say "without these there will be no pictures or no live messages: ${extra[*]}"; return; }
      die "these Debian packages are missing, and there is neither root nor sudo to install them. As root:
  apt-get update && apt-get install --no-install-recommends ${required[*]} ${extra[*]}"
    fi
    say "installing ${required[*]} ${extra[*]}"
    : >"$log"
    as_root env LC_ALL=C apt-get -q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 update >>"$log" 2>&1 ||
      say "apt-get update failed (see $log); going on with the package lists that are there"
    if [ ${#required[@]} -gt 0 ] && ! apt_install "$log" "${required[@]}"; then
      cat "$log" >&2
      die "apt-get could not install what is needed: its output is above"
    fi
    if [ ${#extra[@]} -gt 0 ] && ! apt_install "$log" "${extra[@]}"; then
      say "could not install ${extra[*]} (see $log): there will be no pictures or no live messages"
    fi
  fi
  cp "$ballast_root/launch/packages.txt" "$stamp"
}

# configure FOLDER CMAKE-OPTION...: if it has never been done, or was done with other options.
configure() {
  local folder=$1 log="$1/configure.log"
  shift
  mkdir -p "$folder"
  [ -f "$folder/build.ninja" ] && [ "$(cat "$folder/.options" 2>/dev/null)" = "$*" ] && return
  if ! cmake -S "$ballast_root" -B "$folder" -G Ninja "$@" >"$log" 2>&1; then
    cat "$log" >&2
    die "cmake failed: its output is above"
  fi
  printf '%s' "$*" >"$folder/.options"
}

# build FOLDER TARGET...: one line that counts on a terminal, one plain line elsewhere; everything if it fails.
build() {
  local folder=$1 log="$1/build.log" line announced=
  shift
  if ! ninja -C "$folder" "$@" 2>&1 | tee "$log" | while IFS= read -r line; do
    [[ $line == '['*Building* || $line == '['*Linking* ]] || continue
    if [ -t 2 ]; then
      printf '\r\033[Kballast: building %s' "${line%%]*}]" >&2
    elif [ -z "$announced" ]; then
      announced=1
      say "building in $folder (the first time that takes minutes)"
    fi
  done; then
    [ -t 2 ] && printf '\r\033[K' >&2
    cat "$log" >&2
    die "the build failed: its output is above"
  fi
  [ -t 2 ] && printf '\r\033[K' >&2
  return 0
}

# with_lock COMMAND...: one set-up at a time.
with_lock() {
  if ! mkdir -p "$ballast_build" || ! [ -w "$ballast_build" ]; then
    die "cannot write to $ballast_build: set BALLAST_BUILD to a folder that may be written to"
  fi
  exec 9>"$ballast_build/.lock"
  if ! flock -n 9; then
    say "another set-up is under way: waiting for it"
    flock 9
  fi
  "$@"
  exec 9>&-
}

# The product. A build folder that has the tests keeps them.
set_up_product() {
  install_packages build optional
  [ -f "$ballast_build/build.ninja" ] || configure "$ballast_build" -DCMAKE_BUILD_TYPE=Release -DBALLAST_TESTS=OFF
  build "$ballast_build" ballast_product
}

# The product and what `ballast report` needs to draw its page.
set_up_report() {
  set_up_product
  install_packages report
}

# The product, its tests and its benchmarks.
set_up_tests() {
  install_packages build optional report test
  configure "$ballast_build" -DCMAKE_BUILD_TYPE=Release -DBALLAST_TESTS=ON
  build "$ballast_build" all
}
