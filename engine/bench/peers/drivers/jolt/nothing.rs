// SPDX-License-Identifier: MIT
//! Nothing to compile: cargo only fetches what Cargo.toml names.
