#!/bin/sh
# The bits of the elementary functions, compiled by clang: one hash for it and gcc. Exit code 77: there is no clang.
#   tests/core/elementary_clang.sh
set -eu
clang=$(command -v clang++ || command -v clang++-14) || exit 77
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for level in -O0 -O3; do
  "$clang" -std=c++17 "$level" -ffp-contract=off -I. libslam/core/elementary.cpp libslam/core/elementary_angles.cpp \
    libslam/core/random.cpp tests/core/elementary_test.cpp -lgtest -lgtest_main -lpthread -o "$folder/test"
  "$folder/test" --gtest_brief=1 --gtest_filter=-ElementaryValues.AreThoseOfTheWholeProgram
done
