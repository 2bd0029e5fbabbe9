use super::*;
use crate::units::Unit;

#[test]
fn two_channels_of_one_name_go_by_their_numbers() {
    let twins = [Meta::new("a", Unit::opaque("V")), Meta::new("a", Unit::opaque("V"))];
    let found = |wanted| find_channel(Path::new("x"), wanted, twins.iter());
    assert!(found("a").unwrap_err().to_string().contains("2 channels are called"));
    assert_eq!(found("2").unwrap(), 1);
}
