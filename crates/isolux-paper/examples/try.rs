use isolux_paper::beyond::*;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    for seed in held_out::CAMERAS {
        let t = std::time::Instant::now();
        let h = held_out::HeldOut::new(seed)?;
        println!("{} {:?}", h.model.name, t.elapsed());
        for (c, d) in chains::ALL.iter().zip(decay::measure(&h, &chains::ALL)?) {
            println!("  {:30} cv {:.2} % of {}", c.name, 100.0 * d.cv, d.positions);
        }
        let s = still::measure(&h, &chains::ALL)?;
        println!("  kept {:.4} floor {:?}", s.kept, s.floor.median_cv);
        for (c, d) in chains::ALL.iter().zip(s.chains) {
            println!("  {:30} {:?} {:?}", c.name, d.median_cv, d.valid);
        }
        println!("{:?}", t.elapsed());
    }
    Ok(())
}
