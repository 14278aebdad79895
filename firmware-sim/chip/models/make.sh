#!/usr/bin/env bash
# Learns the models that the images carry, each from exact motion of seed 0, bit for bit as they lie here.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../../.. && pwd)
leastaction() { cargo run --quiet --release --manifest-path "$root/Cargo.toml" --package leastaction -- "$@"; }
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cp ./*.toml "$folder"

leastaction generate cartpole -o "$folder/cartpole.npz"
leastaction generate n-pendulum -o "$folder/double.npz"
leastaction generate rod-pendulum --count 2 -o "$folder/pendulums.npz"
for model in cartpole double pendulums; do
    leastaction train "$folder/$model.toml" -o "$folder/$model" --quiet
    leastaction export "$folder/$model" -o "$model.postcard"
done
leastaction export "$folder/cartpole" -o cartpole-f16.postcard --weights f16
