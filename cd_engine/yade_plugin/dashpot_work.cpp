#include "dashpot_work.hpp"
#include "inheritance.hpp"
#include "layout.hpp"

namespace cd_engine {

void DashpotWork::action()
{
	double power = 0;
	void* const list = at<boost::shared_ptr<yade::InteractionContainer>>(scene, layout.scene_interactions).get();
	for (const auto& interaction : at<std::vector<boost::shared_ptr<yade::Interaction>>>(list, layout.interactions_linear)) {
		// Where only the bounds of a pair overlap there is no geom, and phys is from before, or none.
		void* const geom = at<boost::shared_ptr<yade::IGeom>>(interaction.get(), layout.interaction_geom).get();
		if (!geom || !inherits(geom, Base::ScGeom))
			continue;
		void* const phys = at<boost::shared_ptr<yade::IPhys>>(interaction.get(), layout.interaction_phys).get();
		if (!phys || !inherits(phys, Base::FrictViscoPhys))
			continue;
		const double coefficient = at<double>(phys, layout.phys_cn);
		if (!(coefficient > 0))
			continue;
		const double radii = at<double>(geom, layout.geom_refR1) + at<double>(geom, layout.geom_refR2);
		const double alpha = radii / (radii - at<double>(geom, layout.geom_penetrationDepth));
		power += at<Vector3r>(phys, layout.phys_normalViscous).squaredNorm() / (coefficient * alpha);
	}
	work += power * at<double>(scene, layout.scene_dt);
}

} // namespace cd_engine
