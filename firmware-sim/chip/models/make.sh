#!/usr/bin/env bash
# Learns the models that the images carry: each from exact motion of seed 0, but cartpole-dry from the logs of a simulated robot
# (docs/book/src/swing-up.md); and plans the swing-up of the latter, and a motion of the double pendulum.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../../.. && pwd)
leastaction() { cargo run --quiet --release --manifest-path "$root/Cargo.toml" --package leastaction -- "$@"; }
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cp ./*.toml "$folder"

leastaction generate pendulum -o "$folder/pendulum.npz"
leastaction generate cartpole -o "$folder/cartpole.npz"
leastaction generate n-pendulum -o "$folder/double.npz"
leastaction generate rod-pendulum --count 2 -o "$folder/pendulums.npz"
leastaction generate acrobot -o "$folder/acrobot.npz"
leastaction generate cartpole --robot "$folder/logs" --trajectories 12 --samples 401 --amplitude 1,5 --frequency 0.3,2 \
    --spread 0.5 --coulomb 0.5,0 --width 0.05 --gain 0.9 --delay 8 --zeros 0.02 --noise 0.001 --grid 0.0005
for model in pendulum cartpole cartpole-16 double pendulums acrobot cartpole-dry; do
    leastaction train "$folder/$model.toml" -o "$folder/$model" --quiet
    leastaction export "$folder/$model" -o "$model.postcard"
done
for plan in swing-up reach; do
    leastaction plan $plan.toml -o "$folder/plan-$plan" --quiet
    cp "$folder/plan-$plan/plan.postcard" $plan.postcard
done
cargo run --quiet --manifest-path "$root/Cargo.toml" --package leastaction-tests --bin arm_model arm.postcard
cargo run --quiet --manifest-path "$root/Cargo.toml" --package leastaction-tests --bin sticking_model cartpole-sticking.postcard
leastaction export "$folder/cartpole" -o cartpole-f16.postcard --weights f16
cargo run --quiet --manifest-path "$root/Cargo.toml" --package leastaction-tests --example constants cartpole.postcard >cartpole_constants.rs
