//! What becomes of a fault.

use super::*;

#[test]
fn a_fault_of_the_work_is_told_as_an_error_is() {
    let why = |work: fn() -> Result<u8, WorkbenchError>| sound(work).map_err(|error| error.to_string());
    assert_eq!(why(|| Ok(7)), Ok(7));
    assert_eq!(why(|| Err(WorkbenchError::Stopped)), Err("stopped".to_owned()));
    let told = why(|| panic!("a fault of the work's own"));
    assert_eq!(told, Err(WorkbenchError::Fault.to_string()));
}
