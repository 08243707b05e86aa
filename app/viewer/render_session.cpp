#include "app/viewer/render_session.h"

#include <utility>

#include "app/viewer/director.h"

namespace ivory {

RenderSession::RenderSession(Settings settings)
    : director_(std::make_unique<Director>(std::move(settings))) {}

RenderSession::~RenderSession() = default;

void RenderSession::show(PictureRequest request) { director_->show(std::move(request)); }

void RenderSession::stays() { director_->stays(); }

PictureChange RenderSession::poll() { return director_->poll(shown_, state_, shown_since_); }

bool RenderSession::wait_until_showable(std::chrono::steady_clock::time_point time) const {
    return director_->wait_until_showable(time);
}

SessionTotals RenderSession::totals() const { return director_->totals(); }

}  // namespace ivory
