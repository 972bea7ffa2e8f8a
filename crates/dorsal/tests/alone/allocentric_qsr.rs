use allocentric_qsr::{Case, CompositionTable, DepthReference, Mode};

fn main() {
    let reference = DepthReference::drs1();
    print!("{}", CompositionTable::new(&reference, Case::One, Mode::Published));
}
