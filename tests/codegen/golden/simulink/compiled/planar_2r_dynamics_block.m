function [M, Cqdot, g] = planar_2r_dynamics_block(q, qdot)
%PLANAR_2R_DYNAMICS_BLOCK  The text of a MATLAB Function block.
%#codegen
assert(numel(q) == 2);
assert(numel(qdot) == 2);
[M, Cqdot, g] = planar_2r_dynamics(q, qdot);
end
