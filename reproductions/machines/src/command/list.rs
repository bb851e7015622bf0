//! `machine list`.

use crate::description::BUILTIN;
use crate::{Machine, MachineError};
use report::{Cell, Column, Table, say, say_text};

/// What to list.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print the description of a built-in machine, to start one's own from.
    #[arg(long, value_name = "NAME")]
    toml: Option<String>,
}

/// Prints the built-in machines with every torque model of theirs.
pub fn run(arguments: &Arguments) -> Result<(), MachineError> {
    if let Some(name) = &arguments.toml {
        let found = BUILTIN.iter().find(|(builtin, _)| builtin == name);
        let Some((_, text)) = found else {
            return Err(MachineError::Unknown {
                name: name.clone(),
                builtins: BUILTIN.map(|(name, _)| name).join(", "),
            });
        };
        say_text!(text);
        return Ok(());
    }
    let mut table = Table::new([
        Column::text("machine"),
        Column::number("dynamic model"),
        Column::number("axes"),
        Column::text("parameters (and fv, fc of every axis)"),
    ]);
    for (name, _) in BUILTIN {
        let machine = Machine::load(name)?;
        for number in 1..=machine.description().kind.models() {
            let machine = machine.with_dynamic_model(number)?;
            let own = &machine.parameters()[..machine.model_parameters()];
            let names: Vec<&str> = own.iter().map(|p| p.name.as_str()).collect();
            let shown = if names.len() > 12 {
                format!("{}, … ({})", names[..8].join(", "), names.len())
            } else {
                names.join(", ")
            };
            table = table.row([
                Cell::text(name),
                Cell::number(number as f64, 0),
                Cell::number(machine.dof() as f64, 0),
                Cell::text(shown),
            ]);
        }
    }
    say_text!(table.to_text());
    say!();
    Ok(())
}
