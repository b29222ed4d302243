#!/bin/sh
# install_test.sh BUILD_DIR CXX: installs the client into a scratch prefix and builds a ten-line consumer against it,
# with find_package and with pkg-config. The consumer says what it found when it runs.
set -eu
build=$1 cxx=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build/client" --prefix "$work/prefix" >"$work/install.log"
mv "$work/prefix" "$work/moved"  # an installed tree may be moved

mkdir "$work/consumer"
cat >"$work/consumer/main.cpp" <<'CPP'
#include <cstdio>
#include <scree_client.hpp>
int main() {
  scree::client::Config config;
  config.bind = "127.0.0.1:0";
  static scree::client::Client map;
  if (!map.open(config)) return std::fprintf(stderr, "%s\n", map.error()), 1;
  map.poll();
  std::printf("cost %d\n", map.cost(1.0, 2.0));
}
CPP
cat >"$work/consumer/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.13)
project(consumer CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(scree_client 0.1 REQUIRED)
add_executable(consumer main.cpp)
target_link_libraries(consumer scree::client)
CMAKE

cmake -S "$work/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/moved" -DCMAKE_CXX_COMPILER="$cxx" >"$work/cmake.log" 2>&1 ||
  { cat "$work/cmake.log"; exit 1; }
cmake --build "$work/build" >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }
[ "$("$work/build/consumer")" = "cost 255" ]
echo "find_package: ok"

if ! command -v pkg-config >/dev/null; then
  echo "pkg-config: skipped, it is not installed here"
  exit 0
fi
export PKG_CONFIG_PATH="$work/moved/share/pkgconfig"
flags=$(pkg-config --cflags --libs scree_client)
# a planner may well build without exceptions, and with all warnings
$cxx -std=c++17 -fno-exceptions -fno-rtti -Wall -Wextra -Wpedantic -Werror $flags "$work/consumer/main.cpp" -o "$work/by_pkg_config"
[ "$("$work/by_pkg_config")" = "cost 255" ]
[ "$(pkg-config --modversion scree_client)" = "$(sed -n 's/^set(PACKAGE_VERSION "\(.*\)")/\1/p' "$work/moved/share/cmake/scree_client/scree_clientConfigVersion.cmake")" ]
echo "pkg-config: ok"
test -f "$work/moved/share/scree/client/scree_client.py"
test -f "$work/moved/share/scree/client/scree.lua"

# the example of docs/client.md, as it stands there
source=$(dirname "$(readlink -f "$0")")/../..
sed -n '/^```cpp$/,/^```$/p' "$source/docs/client.md" | sed '1d;/^```$/,$d' >"$work/planner.cpp"
grep -q 'int main' "$work/planner.cpp"
$cxx -std=c++17 -Wall -Wextra -Werror $flags "$work/planner.cpp" -o "$work/planner"
echo "example: ok"
