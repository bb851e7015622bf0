//! Programs that reproduce figures of source documents.

mod control;
mod oracle;
