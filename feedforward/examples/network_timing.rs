//! Time of one sample through the six units of the paper's size, streaming, one thread.
//!
//! `cargo run --release -p residyn-feedforward --example network_timing`

use std::time::Instant;

use feedforward::network::{
    Architecture, Bounds, Compensator, Fade, Memory, Normaliser, Recurrent, Unit,
};

fn compensator(memory: Memory) -> Option<Compensator> {
    let architecture = Architecture::Recurrent(Recurrent {
        encoder: 128,
        attention: Some(128),
        reencoder: 128,
        memory,
    });
    let mut units = Vec::new();
    for joint in 0..6 {
        let columns: Vec<usize> = (0..3)
            .flat_map(|block| (joint..6).map(move |j| 6 * block + j))
            .collect();
        let d = columns.len();
        let identity = (0..d * d)
            .map(|k| if k % (d + 1) == 0 { 1.0 } else { 0.0 })
            .collect();
        let count = architecture.parameter_count(d)?;
        units.push(Unit {
            joint,
            enabled: true,
            architecture: architecture.clone(),
            columns,
            input: Normaliser::new(vec![0.0; d], vec![1.0; d])?,
            target: Normaliser::new(vec![0.0], vec![1.0])?,
            bounds: Bounds::new(
                vec![-1.0; d],
                vec![1.0; d],
                vec![0.0; d],
                identity,
                9.0,
                50.0,
                Fade::default(),
            )?,
            members: vec![
                (0..count)
                    .map(|k| ((k * 7919 % 2003) as f32 / 1001.5 - 1.0) * 0.09)
                    .collect(),
            ],
        });
    }
    let joints = (1..=6).map(|j| format!("joint_{j}")).collect();
    let inputs = (0..18).map(|c| format!("column_{c}")).collect();
    Some(Compensator {
        joints,
        inputs,
        units,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, memory) in [
        ("windows of 3", Memory::Window { timestep: 3 }),
        ("carried state, 3 attended", Memory::Carried { attended: 3 }),
    ] {
        let mut stream = compensator(memory).ok_or("sizes")?.stream()?;
        let (mut inputs, mut torque) = ([0.0_f32; 18], [0.0; 6]);
        let mut times = Vec::with_capacity(10_000);
        for i in 0..10_000 {
            inputs
                .iter_mut()
                .enumerate()
                .for_each(|(c, x)| *x = (i as f32 * 1e-3 + c as f32).sin());
            let start = Instant::now();
            stream.step(&inputs, &mut torque);
            times.push(start.elapsed());
        }
        times.sort_unstable();
        let at =
            |share: f64| times[(share * (times.len() - 1) as f64) as usize].as_secs_f64() * 1e6;
        println!(
            "{name}: median {:.0} µs, p99 {:.0} µs, p99.9 {:.0} µs",
            at(0.5),
            at(0.99),
            at(0.999)
        );
    }
    Ok(())
}
