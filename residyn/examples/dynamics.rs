//! A robot from a URDF text: torque for a motion, and the motion back from the torque.
//!
//! `cargo run --release -p residyn --example dynamics`

use residyn::{Robot, RobotError, Workspace, forward_dynamics, inverse_dynamics, mass_matrix};

/// Two links of half a metre that swing in a vertical plane.
const ARM: &str = r#"
<robot name="two_links">
  <link name="base"/>
  <link name="upper">
    <inertial><mass value="4"/><origin xyz="0.25 0 0"/><inertia ixx="0.01" iyy="0.09" izz="0.09" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="fore">
    <inertial><mass value="2"/><origin xyz="0.2 0 0"/><inertia ixx="0.005" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="3" effort="80"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="3" effort="40"/>
  </joint>
</robot>"#;

fn main() -> Result<(), RobotError> {
    let robot = Robot::from_urdf_str(ARM)?;
    let mut workspace = Workspace::new(&robot);
    let (q, qd, qdd) = ([0.3, -0.8], [1.0, 0.5], [2.0, -1.0]);

    let mut tau = [0.0; 2];
    inverse_dynamics(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
    println!("torque       {tau:8.3?} N·m at {:?}", robot.joint_names());

    let mut mass = [0.0; 4];
    mass_matrix(&robot, &mut workspace, &q, &mut mass);
    println!("mass matrix  {mass:8.3?} kg·m²");

    let mut back = [0.0; 2];
    forward_dynamics(&robot, &mut workspace, &q, &qd, &tau, &[], &mut back);
    println!("acceleration {back:8.3?} rad/s², from that torque");
    assert!(back.iter().zip(qdd).all(|(b, a)| (b - a).abs() < 1e-9));
    Ok(())
}
