#!/bin/sh
# start.sh LOG OUTPUT: the program of this folder, or what to do when it is not built.
folder=$(cd "$(dirname "$0")" && pwd)
if [ ! -x "$folder/build/@name@" ]; then
  echo "@name@ is not built: cmake -S $folder -B $folder/build && cmake --build $folder/build" >&2
  exit 1
fi
exec "$folder/build/@name@" "$@"
