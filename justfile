# Commands for daily work; `just` lists them.

_default:
    @just --list

# Everything that must pass
ci:
    bash .ci/run

# All tests
test:
    cargo test --workspace

# Format and lint
lint:
    cargo fmt --all
    cargo clippy --workspace --all-targets -- -D warnings

# The point-wise chain beside memcpy
bench:
    cargo bench -p isolux

# The picture in the README
picture:
    cargo run --release -- demo
    cp isolux-demo/before-after-integration-times.png docs/before-after.png
