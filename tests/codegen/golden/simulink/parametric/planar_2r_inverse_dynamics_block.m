function [tau] = planar_2r_inverse_dynamics_block(q, qdot, qddot)
%PLANAR_2R_INVERSE_DYNAMICS_BLOCK  The text of a MATLAB Function block.
%#codegen
assert(numel(q) == 2);
assert(numel(qdot) == 2);
assert(numel(qddot) == 2);
[tau] = planar_2r_inverse_dynamics(q, qdot, qddot, planar_2r_params());
end
