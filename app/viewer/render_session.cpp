#include "app/viewer/render_session.h"

#include <utility>

#include "app/viewer/director.h"

namespace ivory {

RenderSession::RenderSession(Settings settings)
    : director_(std::make_unique<Director>(std::move(settings))) {}

RenderSession::~RenderSession() = default;

void RenderSession::show(PictureRequest request) { director_->show(std::move(request)); }

PictureChange RenderSession::poll(FirstPicture first) {
    return director_->poll(first, shown_, state_, seconds_until_due_);
}

bool RenderSession::first_picture_ready() const { return director_->first_picture_ready(); }

SessionTotals RenderSession::totals() const { return director_->totals(); }

}  // namespace ivory
