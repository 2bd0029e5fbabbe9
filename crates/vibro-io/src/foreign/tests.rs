use crate::reader::Reader;

#[test]
fn each_is_named_with_its_way_out() {
    for (name, head, words) in [
        ("x.svd", &b"\x01\x02\0\0"[..], ["Polytec", "Universal File"]),
        ("x.trc", b"#9000000346WAVEDESC\0\0\0", ["LeCroy", "CSV"]),
        ("x.mf4", b"MDF     4.10\0\0", ["MDF 4", "asammdf"]),
        ("x.ide", b"\x1a\x45\xdf\xa3\x01\0", ["enDAQ", "CSV"]),
        ("x.bin", b"\x94\x13\x02\0\0", ["catman", "ASCII"]),
        ("x.segy", b"\xc3\x40\xf1\x40\xc3", ["SEG-Y", "ObsPy"]),
        ("x.sac", b"\0\0\x80\x3f\0", ["SAC", "ObsPy"]),
        ("x.mseed", b"000001D \0\x01", ["miniSEED", "SLIST"]),
        ("x.c3d", b"\x02\x50\0\x01", ["C3D", "CSV"]),
        #[cfg(not(feature = "hdf5"))]
        ("x.h5", b"\x89HDF\r\n\x1a\n\0", ["HDF5", "MAT"]),
        ("x.dat", b"|CF,2,1,1;|CK,1,3,1,1;", ["FAMOS", "ASCII"]),
        (
            "x.mat",
            b"# Created by Octave 8\n# name: t\n# type: scalar\n1\n\n\n# name: a\n# type: scalar\n2\n",
            ["Octave", "save -v7"],
        ),
    ] {
        let said = Reader::new().from_reader(name, head).unwrap_err();
        let said = said.to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
    }
    // A text file is not refused by its ending.
    assert!(Reader::new().from_reader("x.svd", &b"0.5\n1.5\n2.5\n"[..]).is_ok());
}
