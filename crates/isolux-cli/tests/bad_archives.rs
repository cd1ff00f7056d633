//! Archives that are damaged, or that attack: one clear message, nothing left behind.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, READERS, Sandbox, archive, header, npz, refused_by};
use zip::CompressionMethod::{self, Deflated, Stored};

fn amplitude() -> Array {
    common::sweep().swap_remove(0).1
}

#[test]
fn archives_that_cannot_be_read() {
    let array = amplitude().bytes();
    let one = |method| archive(&[("amplitude.npy", array.clone())], method);
    let stored = one(Stored);
    let encrypted = {
        let mut bytes = stored.clone();
        let central = bytes.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
        bytes[6] |= 1;
        bytes[central + 8] |= 1;
        bytes
    };
    let damaged = {
        let mut bytes = one(Deflated);
        let middle = bytes.len() / 3;
        bytes[middle] ^= 0xff;
        bytes
    };
    // The writer refuses two members of one name, so the second one's name is changed afterwards.
    let double = {
        let mut bytes =
            archive(&[("amplitude.npy", array.clone()), ("amplitudf.npy", array.clone())], Stored);
        while let Some(at) = bytes.windows(9).position(|window| window == b"amplitudf") {
            bytes[at + 8] = b'e';
        }
        bytes
    };
    let claim = archive(&[("amplitude.npy", header("<f8", false, &[1 << 20, 1 << 10, 1 << 10]))], Deflated);
    let cases: [(&[u8], &[&str]); 6] = [
        (&stored[..stored.len() - 10], &["`bad.npz`: found damaged data"]),
        (&encrypted, &["`bad.npz/amplitude.npy`: found an encrypted member"]),
        (&damaged, &["bad.npz", "expected"]),
        (&double, &["`bad.npz`: found two members of one name"]),
        (&claim, &["`bad.npz/amplitude.npy`", "(1048576, 1024, 1024) of float64"]),
        (&archive(&[("readme.txt", b"x".to_vec())], Stored), &["`bad.npz`: found no `amplitude`"]),
    ];
    for (bytes, parts) in cases {
        let sandbox = Sandbox::new();
        sandbox.write("bad.npz", bytes);
        refused_by(&READERS, &sandbox, "bad.npz", parts);
    }
}

#[test]
fn members_that_climb_out_of_an_archive_are_left_alone() {
    let array = amplitude().bytes();
    let names = ["amplitude.npy", "../climbed.npy", "..\\climbed.npy", "/tmp/climbed.npy", "sub/climbed.npy"];
    let members: Vec<_> = names.iter().map(|name| (*name, array.clone())).collect();
    let sandbox = Sandbox::new();
    sandbox.write("work/rec.npz", archive(&members, Stored));
    sandbox.run("standardize work/rec.npz -o work/out --keep-input").done();
    let written: Vec<_> = sandbox.snapshot().into_keys().collect();
    assert!(written.iter().all(|path| !path.to_string_lossy().contains("climbed")), "{written:?}");
    assert_eq!(sandbox.array("work/out/amplitude.npy").1, common_data(&array));
}

fn common_data(npy: &[u8]) -> Vec<u8> {
    npy[npy.len() - 4 * 5 * 6 * 4..].to_vec()
}

/// Damage behind the header is met while frames are read, when the output has been begun.
#[test]
fn damage_behind_the_first_frames_leaves_no_output() {
    let method = CompressionMethod::Deflated;
    // Without a pattern, so that a damaged byte of the packed data hits a value.
    let noise = |i: usize| f64::from((i as u32).wrapping_mul(2_654_435_761) >> 8);
    let values = (0..40 * 32 * 32).map(noise).collect();
    let mut bytes = npz(&[("amplitude", Array::new("<u4", &[40, 32, 32], values))], method);
    let place = bytes.len() * 3 / 4;
    bytes[place] ^= 0xff;
    let sandbox = Sandbox::new();
    sandbox.write("bad.npz", bytes);
    let commands = ["standardize BAD -o out", "standardize BAD -o out.npz --keep-input", "evaluate BAD"];
    refused_by(&commands, &sandbox, "bad.npz", &["`bad.npz/amplitude.npy`", "damaged data"]);
}
