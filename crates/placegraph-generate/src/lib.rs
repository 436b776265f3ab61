//! Generated buildings with perfect ground truth, mapped by a simulated robot.
